"""The fixed-function API itself: lights, materials, light model, and one picture as linear float32 radiance."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from equilux_adapters._triangles.depth import clipping_range
from equilux_adapters._triangles.view import Mesh, View, seen_from
from equilux_adapters.opengl.kit.context import started

Array = Any


@dataclass(frozen=True)
class Light:
    """position: world, metres, or None for a light at infinity. direction: the way the light travels, along the axis of a spot.

    cutoff_deg: half-angle of the cone, 180 where there is none. attenuation: constant, linear and quadratic term.
    """

    ambient: Array = (0, 0, 0)
    diffuse: Array = (0, 0, 0)
    specular: Array = (0, 0, 0)
    position: Array | None = None
    direction: Array | None = None
    attenuation: Array = (1, 0, 0)
    cutoff_deg: float = 180.0
    exponent: float = 0.0


@dataclass(frozen=True)
class Surface:
    """A material."""

    ambient: Array = (0, 0, 0)
    diffuse: Array = (0, 0, 0)
    specular: Array = (0, 0, 0)
    emission: Array = (0, 0, 0)
    shininess: float = 0.0


@dataclass(frozen=True)
class Scene:
    """All there is to draw; ambient: the light model's own. local_viewer: V goes to the eye point, else it is minus the view
    direction."""

    view: View
    lights: Sequence[Light]
    objects: Sequence[tuple[Mesh, Surface]]
    ambient: Array = (0, 0, 0)
    background: Array = (0, 0, 0)
    local_viewer: bool = True


def render(scene: Scene) -> Array:
    """(height, width, 3) float32, row 0 on top.

    A pass has as many lights as the API knows, at least eight; emission, global ambient light and background are in the first
    pass only, and the passes are added in double.
    """
    from OpenGL import GL

    most = int(started()["opengl_lights"])
    total = np.zeros((scene.view.height, scene.view.width, 3))
    with float_framebuffer(scene.view):
        set_camera(scene)
        for first in range(0, max(len(scene.lights), 1), most):
            alone = 1.0 if first == 0 else 0.0
            GL.glClearColor(*(alone * np.asarray(scene.background)), 1)
            GL.glClear(GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT)
            set_light_model(scene, alone)
            for number in range(most):
                set_light(scene.view, number, scene.lights[first + number] if first + number < len(scene.lights) else None)
            for mesh, surface in scene.objects:
                set_surface(surface, alone)
                draw(scene.view, mesh)
            total += read_pixels(scene.view)
    return total.astype(np.float32)


def set_light_model(scene: Scene, alone: float) -> None:
    """What belongs to no light, and how the direction to the viewer is taken."""
    from OpenGL import GL

    GL.glEnable(GL.GL_LIGHTING)
    GL.glEnable(GL.GL_NORMALIZE)
    GL.glShadeModel(GL.GL_SMOOTH)
    GL.glLightModelfv(GL.GL_LIGHT_MODEL_AMBIENT, (*(alone * np.asarray(scene.ambient)), 1))
    GL.glLightModeli(GL.GL_LIGHT_MODEL_LOCAL_VIEWER, scene.local_viewer)


def set_light(view: View, number: int, light: Light | None) -> None:
    """One of the API's lights, in eye coordinates like all that is drawn."""
    from OpenGL import GL

    name = GL.GL_LIGHT0 + number
    if light is None:
        GL.glDisable(name)
        return
    GL.glEnable(name)
    GL.glLightfv(name, GL.GL_AMBIENT, (*light.ambient, 1))
    GL.glLightfv(name, GL.GL_DIFFUSE, (*light.diffuse, 1))
    GL.glLightfv(name, GL.GL_SPECULAR, (*light.specular, 1))
    if light.position is None:
        GL.glLightfv(name, GL.GL_POSITION, (*eye_axes(view, -unit(light.direction)), 0))
    else:
        GL.glLightfv(name, GL.GL_POSITION, (*eye_axes(view, np.asarray(light.position) - view.eye), 1))
    for term, value in zip(("CONSTANT", "LINEAR", "QUADRATIC"), light.attenuation, strict=True):
        GL.glLightf(name, getattr(GL, f"GL_{term}_ATTENUATION"), value)
    GL.glLightf(name, GL.GL_SPOT_CUTOFF, light.cutoff_deg)
    GL.glLightf(name, GL.GL_SPOT_EXPONENT, light.exponent)
    if light.cutoff_deg <= 90:
        GL.glLightfv(name, GL.GL_SPOT_DIRECTION, eye_axes(view, unit(light.direction)))


def eye_axes(view: View, vectors: Array) -> Array:
    """World axes → the API's eye axes, right, up and against the view, in double: the modelview matrix stays the identity.

    In single precision the matrix would move what is far away by more than a pixel of a narrow view is wide (Q9).
    """
    turned = seen_from(view, np.atleast_2d(vectors)) * (1, 1, -1)
    return turned.reshape(np.shape(vectors))


def unit(direction: Array) -> Array:
    """In double, whatever the length."""
    scaled = np.asarray(direction, dtype=float) / np.max(np.abs(direction))
    return scaled / np.linalg.norm(scaled)


def set_surface(surface: Surface, alone: float) -> None:
    """The material of all that is drawn next."""
    from OpenGL import GL

    GL.glMaterialfv(GL.GL_FRONT_AND_BACK, GL.GL_AMBIENT, (*surface.ambient, 1))
    GL.glMaterialfv(GL.GL_FRONT_AND_BACK, GL.GL_DIFFUSE, (*surface.diffuse, 1))
    GL.glMaterialfv(GL.GL_FRONT_AND_BACK, GL.GL_SPECULAR, (*surface.specular, 1))
    GL.glMaterialfv(GL.GL_FRONT_AND_BACK, GL.GL_EMISSION, (*(alone * np.asarray(surface.emission)), 1))
    GL.glMaterialf(GL.GL_FRONT_AND_BACK, GL.GL_SHININESS, surface.shininess)


def draw(view: View, mesh: Mesh) -> None:
    """A mesh as indexed triangles; rounded to single precision here."""
    from OpenGL import GL

    if len(mesh.triangles) == 0:
        return
    points, normals = (eye_axes(view, values).astype(np.float32) for values in (mesh.points, mesh.normals))
    indices = np.ascontiguousarray(mesh.triangles, dtype=np.uint32)
    GL.glEnableClientState(GL.GL_VERTEX_ARRAY)
    GL.glEnableClientState(GL.GL_NORMAL_ARRAY)
    GL.glVertexPointer(3, GL.GL_FLOAT, 0, points)
    GL.glNormalPointer(GL.GL_FLOAT, 0, normals)
    GL.glDrawElements(GL.GL_TRIANGLES, indices.size, GL.GL_UNSIGNED_INT, indices)
    GL.glFinish()  # the arrays are this function's own


def set_camera(scene: Scene) -> None:
    """The eye is the origin of all coordinates, so that the API's rule "V goes to the origin" is the model's."""
    from OpenGL import GL

    view = scene.view
    near, far = clipping_range(view, [mesh for mesh, _ in scene.objects])
    reach = 1.0 if view.parallel else near
    x, y = reach * view.half_width, reach * view.half_height
    GL.glViewport(0, 0, view.width, view.height)
    GL.glMatrixMode(GL.GL_PROJECTION)
    GL.glLoadIdentity()
    (GL.glOrtho if view.parallel else GL.glFrustum)(-x, x, -y, y, near, far)
    GL.glMatrixMode(GL.GL_MODELVIEW)
    GL.glLoadIdentity()
    GL.glEnable(GL.GL_DEPTH_TEST)
    GL.glDepthFunc(GL.GL_LESS)  # on equal depth the first object stays
    GL.glEnable(GL.GL_CULL_FACE)  # all show their front, see `towards_eye`
    GL.glDisable(GL.GL_DITHER)


@contextmanager
def float_framebuffer(view: View) -> Iterator[None]:
    """Colours of 32-bit floats that nothing clamps, depths of 32-bit floats, one sample per pixel."""
    from OpenGL import GL

    frame, colour, depth = GL.glGenFramebuffers(1), GL.glGenRenderbuffers(1), GL.glGenRenderbuffers(1)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, frame)
    for buffer, storage, place in (
        (colour, GL.GL_RGBA32F, GL.GL_COLOR_ATTACHMENT0),
        (depth, GL.GL_DEPTH_COMPONENT32F, GL.GL_DEPTH_ATTACHMENT),
    ):
        GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
        GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, storage, view.width, view.height)
        GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
    try:
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError("this OpenGL draws into no framebuffer of 32-bit floats")
        GL.glClampColor(GL.GL_CLAMP_VERTEX_COLOR, GL.GL_FALSE)
        GL.glClampColor(GL.GL_CLAMP_FRAGMENT_COLOR, GL.GL_FALSE)
        GL.glClampColor(GL.GL_CLAMP_READ_COLOR, GL.GL_FALSE)
        yield
    finally:
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        GL.glDeleteRenderbuffers(2, [colour, depth])
        GL.glDeleteFramebuffers(1, [frame])


def read_pixels(view: View) -> Array:
    """The colours, turned so that row 0 is on top."""
    from OpenGL import GL

    GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
    pixels = np.empty((view.height, view.width, 3), dtype=np.float32)
    GL.glReadPixels(0, 0, view.width, view.height, GL.GL_RGB, GL.GL_FLOAT, pixels)
    return pixels[::-1]
