"""Frames that hold less than radiance: half floats, eight bits, and means of several samples per pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR
from vtkmodules.vtkRenderingCore import vtkLight, vtkProperty, vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject, vtkPixelBufferObject, vtkTextureObject

from equilux_adapters._triangles.view import Mesh, View
from equilux_adapters.vtk.kit.stage import download, download_texture, float_radiance, offscreen_window, staged

Array = Any

COLOUR_BUFFER = 0x4000
"""OpenGL's name for what of a framebuffer is copied."""

NEAREST = 0x2600
"""OpenGL's name for copying pixel by pixel."""

RGBA16F = 0x881A
"""OpenGL's name for textures of half floats."""

LARGEST_HALF = 65504.0
LEAST_BRIGHT_HALF = 2.0**-6
"""Where nothing is brighter, half floats soon run out of digits: the frame is exposed longer."""

BLACK_LOOKS = 3
"""How often a black frame of eight bits is exposed 2^8 times longer."""


@dataclass(frozen=True)
class Frame:
    """pixels: radiance, (h, w, 3), row 0 on top. full_scale: what a stored 1 stands for. centres: radiance at the pixels' centres
    where pixels are means of samples. capabilities: what OpenGL says of itself."""

    pixels: Array
    full_scale: float
    centres: Array | None
    capabilities: str


def render_limited(
    view: View, background: Array, lights: list[vtkLight], objects: list[tuple[Mesh, vtkProperty]], target: str, samples: int
) -> Frame:
    """One picture in a frame of `float32`, `float16` or `uint8`, exposed so that nothing is clipped: by a power of two.

    samples: per pixel; 0: its centre.
    """
    window = offscreen_window(view.width, view.height)
    try:
        renderer = staged(window, view, background, lights, objects)
        exposures = Exposures(renderer, background, lights, [surface for _, surface in objects])
        full_scale, looked = 1.0, 0
        while True:
            exposures.set(full_scale)
            centres = centres_of(window, renderer, view, target)
            looked += 1
            following = better_scale(target, full_scale, centres, looked)
            if following == full_scale:
                break
            full_scale = following
        pixels = means_of(window, renderer, view, target, samples) if samples else centres
        capabilities = window.ReportCapabilities()
        return Frame(pixels * full_scale, full_scale, centres * full_scale if samples else None, capabilities)
    finally:
        window.Finalize()


class Exposures:
    """All that adds light to a picture, to be dimmed together: colours of lights, what surfaces emit, the background."""

    def __init__(self, renderer: vtkRenderer, background: Array, lights: list[vtkLight], surfaces: list[vtkProperty]) -> None:
        self.renderer, self.background = renderer, np.asarray(background, dtype=float)
        self.lights = [(light, np.array([light.GetDiffuseColor(), light.GetSpecularColor()])) for light in lights]
        self.surfaces = [(surface, np.array(surface.GetAmbientColor())) for surface in dict.fromkeys(surfaces)]

    def set(self, full_scale: float) -> None:
        """A radiance of `full_scale` is stored as 1."""
        self.renderer.SetBackground(*(self.background / full_scale))
        for light, (diffuse, specular) in self.lights:
            light.SetDiffuseColor(*(diffuse / full_scale))
            light.SetSpecularColor(*(specular / full_scale))
        for surface, glow in self.surfaces:
            surface.SetAmbientColor(*(glow / full_scale))


def better_scale(target: str, full_scale: float, stored: Array, looked: int) -> float:
    """The full scale to look with next; the same where this one serves. Powers of two: they cost no digit."""
    brightest = float(np.max(stored))
    if target == "float32":
        return full_scale
    if target == "float16":
        if not brightest < LARGEST_HALF and full_scale < 2.0**100:
            return full_scale * 2.0**12
        dark = 0 < brightest < LEAST_BRIGHT_HALF and looked == 1
        return full_scale * float(2.0 ** np.floor(np.log2(brightest))) if dark else full_scale
    if brightest >= 1 and full_scale < 2.0**100:
        return full_scale * 16
    if brightest == 0:
        return full_scale / 256 if looked <= BLACK_LOOKS else full_scale
    # half a code more, lest it be clipped after all
    wanted = float(2.0 ** np.ceil(np.log2(brightest + 0.5 / 255)))
    return full_scale * wanted if wanted < 1 else full_scale


def centres_of(window: Any, renderer: vtkRenderer, view: View, target: str) -> Array:
    """(height, width, 3) float32: what is stored of the radiance at the pixels' centres."""
    window.SetMultiSamples(0)
    frame = float_radiance()
    formats = {"float32": vtkTextureObject.Float32, "float16": vtkTextureObject.Float16, "uint8": vtkTextureObject.Fixed8}
    frame.SetColorFormat(formats[target])
    renderer.SetPass(frame)
    window.Render()
    pixels = download_codes(frame.GetColorTexture(), view) if target == "uint8" else download(frame, view)
    renderer.SetPass(None)  # type: ignore[arg-type]
    frame.ReleaseGraphicsResources(window)
    return pixels


def means_of(window: Any, renderer: vtkRenderer, view: View, target: str, samples: int) -> Array:
    """(height, width, 3) float32: means over samples. The window's own framebuffer is replaced by one of the target's format."""
    size = (view.width, view.height)
    window.SetMultiSamples(samples)
    window.Render()  # makes the window's framebuffer, of 8 bits
    drawn = window.GetRenderFramebuffer()
    kind = VTK_UNSIGNED_CHAR if target == "uint8" else VTK_FLOAT
    made = drawn.PopulateFramebuffer(*size, True, 1, kind, True, 32, samples, False)
    if made and target == "float16":
        halves = texture(window, view, RGBA16F, drawn.GetMultiSamples())
        drawn.AddColorAttachment(0, halves)
        made = drawn.CheckFrameBufferStatus(drawn.GetBothMode())
    if not made or drawn.GetMultiSamples() < samples:
        raise RuntimeError(f"this OpenGL draws into no framebuffer of {samples} samples per pixel")
    window.Render()
    mean = vtkOpenGLFramebufferObject()
    mean.SetContext(window)
    mean.PopulateFramebuffer(*size, True, 1, kind, True, 32, 0, False)
    drawn.Bind(drawn.GetReadMode())
    drawn.ActivateReadBuffer(0)
    mean.Bind(mean.GetDrawMode())
    mean.ActivateDrawBuffer(0)
    whole = (0, view.width, 0, view.height)
    vtkOpenGLFramebufferObject.Blit(whole, whole, COLOUR_BUFFER, NEAREST)
    result = mean.GetColorAttachmentAsTextureObject(0)
    return download_codes(result, view) if target == "uint8" else download_texture(result, view)


def texture(window: Any, view: View, internal_format: int, samples: int) -> vtkTextureObject:
    """An empty colour texture of the window's size."""
    made = vtkTextureObject()
    made.SetContext(window)
    made.SetSamples(samples)
    made.SetInternalFormat(internal_format)
    made.Allocate2D(view.width, view.height, 4, VTK_FLOAT)
    return made


def download_codes(colours: vtkTextureObject, view: View) -> Array:
    """Codes of eight bits as shares of 255, turned so that row 0 is on top."""
    codes = np.zeros((view.height, view.width, 4), dtype=np.uint8)
    buffer: vtkPixelBufferObject = colours.Download()
    buffer.Download2D(VTK_UNSIGNED_CHAR, codes, [view.width, view.height], 4, [0, 0])
    return codes[::-1, :, :3].astype(np.float64) / 255
