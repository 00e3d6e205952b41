"""VTK itself: lights, materials, and one frame as linear float32 radiance."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import VTK_FLOAT, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkCamera, vtkLight, vtkPolyDataMapper, vtkProperty, vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import (
    vtkCameraPass,
    vtkEGLRenderWindow,
    vtkFramebufferPass,
    vtkLightsPass,
    vtkOpaquePass,
    vtkOSOpenGLRenderWindow,
    vtkPixelBufferObject,
    vtkRenderPassCollection,
    vtkSequencePass,
    vtkTextureObject,
)

from equilux_adapters._triangles.clip import in_frame
from equilux_adapters._triangles.depth import clipping_range
from equilux_adapters._triangles.facing import towards_eye
from equilux_adapters._triangles.view import Mesh, View

Array = Any


def directional_light(direction: Array, irradiance: Array, **shares: Array) -> vtkLight:
    """A light at infinity, travelling along `direction`; shares: see `set_colours`."""
    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPositional(False)
    light.SetPosition(*(-np.asarray(direction, dtype=float)))
    light.SetFocalPoint(0, 0, 0)
    set_colours(light, irradiance, **shares)
    return light


def set_colours(
    light: vtkLight, strength: Array, ambient: Array = (0, 0, 0), diffuse: Array = (1, 1, 1), specular: Array = (1, 1, 1)
) -> None:
    """A light's three colours, each a share of its strength."""
    light.SetAmbientColor(*(np.asarray(strength) * ambient))
    light.SetDiffuseColor(*(np.asarray(strength) * diffuse))
    light.SetSpecularColor(*(np.asarray(strength) * specular))


def point_light(view: View, position: Array, intensity: Array, attenuation: Array, **shares: Array) -> vtkLight:
    """A light at a point; attenuation: constant, linear and quadratic term; shares: see `set_colours`."""
    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPositional(True)
    light.SetPosition(*(np.asarray(position, dtype=float) - view.eye))
    light.SetConeAngle(180)  # not a spot: the default is a cone of 30° (Q8)
    set_colours(light, intensity, **shares)
    light.SetAttenuationValues(*attenuation)
    return light


def spot_light(
    view: View,
    position: Array,
    intensity: Array,
    attenuation: Array,
    direction: Array,
    cone_half_angle_deg: float,
    exponent: float,
    **shares: Array,
) -> vtkLight:
    """A point light within a hard cone, weakened by cos^exponent off its axis."""
    light = point_light(view, position, intensity, attenuation, **shares)
    direction = np.asarray(direction, dtype=float)
    # the axis runs from the position to the focal point
    reach = max(1.0, float(np.max(np.abs(light.GetPosition()))))
    light.SetFocalPoint(*(np.asarray(light.GetPosition()) + reach * direction / np.linalg.norm(direction)))
    light.SetConeAngle(cone_half_angle_deg)
    light.SetExponent(exponent)
    return light


def vtk_array(values: Array, kind: Any) -> Any:
    """A copy that VTK owns."""
    return numpy_to_vtk(np.ascontiguousarray(values, dtype=kind), deep=True)  # type: ignore[no-untyped-call]


def actor(mesh: Mesh, surface: vtkProperty) -> vtkActor:
    """A mesh, already cut to the film, with its material; rounded to single precision here."""
    data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(vtk_array(mesh.points, np.float32))
    cells.SetData(3, vtk_array(mesh.triangles.ravel(), np.int64))
    data.SetPoints(points)
    data.SetPolys(cells)
    # one normal per triangle where it is flat: what is interpolated loses digits far into the depth (Q14)
    normals = mesh.normals[mesh.triangles[:, 0]] if mesh.flat else mesh.normals
    attributes = data.GetCellData() if mesh.flat else data.GetPointData()
    attributes.SetNormals(vtk_array(normals, np.float32))
    mapper = vtkPolyDataMapper()
    mapper.SetVBOShiftScaleMethod(0)  # a shift of VTK's own loses digits near the eye (Q13)
    mapper.SetInputData(data)
    result = vtkActor()
    result.SetMapper(mapper)
    result.SetProperty(surface)
    surface.SetBackfaceCulling(True)  # all show their front, see `towards_eye`
    return result


def offscreen_window(width: int, height: int) -> Any:
    """A window that needs no display: software OSMesa where there is one, else EGL without a surface."""
    for kind, names in (
        (vtkOSOpenGLRenderWindow, ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")),
        (vtkEGLRenderWindow, ("libEGL.so.1", "libEGL.so")),
    ):
        if not any(loadable(name) for name in names):
            continue
        window = kind()
        window.SetOffScreenRendering(True)
        window.SetMultiSamples(0)  # one sample, at the pixel's centre
        window.SetSize(width, height)
        window.Initialize()
        if window.GetInitialized():
            return window
    raise RuntimeError("no OpenGL without a display: neither OSMesa (libOSMesa.so.8) nor EGL (libEGL.so.1) could be started")


def loadable(name: str) -> bool:
    """Whether a shared library is there. VTK crashes on a missing libEGL (Q2)."""
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


def float_radiance() -> vtkFramebufferPass:
    """The frame in a texture of 32-bit floats: the window's own buffer has 8 bits and clamps at 1 (Q1)."""
    steps, camera, frame = vtkSequencePass(), vtkCameraPass(), vtkFramebufferPass()
    passes = vtkRenderPassCollection()
    passes.AddItem(vtkLightsPass())
    passes.AddItem(vtkOpaquePass())
    steps.SetPasses(passes)
    camera.SetDelegatePass(steps)
    frame.SetDelegatePass(camera)
    frame.SetColorFormat(vtkTextureObject.Float32)
    frame.SetDepthFormat(vtkTextureObject.Float32)
    return frame


def render(view: View, background: Array, lights: list[vtkLight], objects: list[tuple[Mesh, vtkProperty]]) -> tuple[Array, str]:
    """One frame: (height, width, 3) float32, row 0 on top; and what OpenGL says of itself."""
    window = offscreen_window(view.width, view.height)
    try:
        renderer = staged(window, view, background, lights, objects)
        renderer.SetPass(frame := float_radiance())
        window.Render()
        return download(frame, view), window.ReportCapabilities()
    finally:
        window.Finalize()


def staged(
    window: Any, view: View, background: Array, lights: list[vtkLight], objects: list[tuple[Mesh, vtkProperty]]
) -> vtkRenderer:
    """All that is to be drawn, in the window."""
    renderer = vtkRenderer()
    renderer.SetBackground(*background)
    renderer.SetAutomaticLightCreation(False)
    window.AddRenderer(renderer)
    for light in lights:
        renderer.AddLight(light)
    seen = [(in_frame(view, towards_eye(view, mesh)), surface) for mesh, surface in objects]
    # on equal depth VTK keeps what is drawn last: the first object has to be that (Q12)
    for mesh, surface in reversed(seen):
        if len(mesh.triangles):
            renderer.AddActor(actor(mesh, surface))
    renderer.SetActiveCamera(camera_of(view, clipping_range(view, [mesh for mesh, _ in seen])))
    return renderer


def camera_of(view: View, near_far: tuple[float, float]) -> vtkCamera:
    """The eye is the origin of all coordinates that VTK is given."""
    camera = vtkCamera()
    camera.SetPosition(0, 0, 0)
    camera.SetFocalPoint(*view.forward)
    camera.SetViewUp(*view.up)
    if view.parallel:
        camera.SetParallelProjection(True)
        camera.SetParallelScale(view.half_height)
    else:
        camera.SetViewAngle(2 * np.degrees(np.arctan(view.half_height)))
    camera.SetClippingRange(*near_far)
    return camera


def download(frame: vtkFramebufferPass, view: View) -> Array:
    """The colour texture, turned so that row 0 is on top."""
    return download_texture(frame.GetColorTexture(), view)


def download_texture(colours: vtkTextureObject, view: View) -> Array:
    """Colours as 32-bit floats, turned so that row 0 is on top."""
    pixels = np.zeros((view.height, view.width, 4), dtype=np.float32)
    buffer: vtkPixelBufferObject = colours.Download()
    buffer.Download2D(VTK_FLOAT, pixels, [view.width, view.height], 4, [0, 0])
    return np.ascontiguousarray(pixels[::-1, :, :3])
