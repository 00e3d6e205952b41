"""A context of the fixed-function API without a display."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from functools import cache
from typing import Any


@cache
def started() -> dict[str, str]:
    """Make a context, unless one is current, and leave it so: EGL without a surface, or else OSMesa. What it says of itself.

    `PYOPENGL_PLATFORM`, where it is set, chooses: `egl` or `osmesa`. The choice holds for the whole process.
    """
    chosen, said = os.environ.get("PYOPENGL_PLATFORM"), []
    for platform, make in (("egl", egl_context), ("osmesa", osmesa_context)):
        if chosen not in (None, platform):
            continue
        if reason := why_not(platform):
            said.append(f"{platform}: {reason}")
            continue
        os.environ["PYOPENGL_PLATFORM"] = platform
        if not current():
            make()
        return {"window": "EGL" if platform == "egl" else "OSMesa", **description()}
    raise RuntimeError("no OpenGL without a display: " + ("; ".join(said) or f"PYOPENGL_PLATFORM is {chosen}"))


def current() -> bool:
    """Whether there is a context already, and one that has the fixed-function API; another library's may not."""
    from OpenGL import GL, platform

    if not platform.GetCurrentContext() or GL.glGetString(GL.GL_VERSION) is None:
        return False
    return not int(GL.glGetIntegerv(GL.GL_CONTEXT_PROFILE_MASK)) & GL.GL_CONTEXT_CORE_PROFILE_BIT


def why_not(platform: str) -> str:
    """Why a platform cannot be used, or "". Asked of the library itself: PyOpenGL takes the first choice for good."""
    names = {"egl": ("libEGL.so.1", "libEGL.so"), "osmesa": ("libOSMesa.so.8", "libOSMesa.so")}[platform]
    library = next((found for name in names if (found := loaded(name))), None)
    if library is None:
        return f"{names[0]} is not installed"
    if platform == "osmesa":
        return ""
    display_of = library.eglGetProcAddress
    display_of.restype, display_of.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    if not (address := display_of(b"eglGetPlatformDisplayEXT")):
        return "it knows no platforms"
    get = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)(address)
    library.eglInitialize.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    display = get(SURFACELESS, None, None)
    return "" if display and library.eglInitialize(display, None, None) else "it has no surfaceless platform"


def loaded(name: str) -> Any:
    """A shared library, or None."""
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


SURFACELESS = 0x31DD
"""EGL_PLATFORM_SURFACELESS_MESA"""


def egl_context() -> None:
    """EGL on no display, with no surface."""
    from OpenGL import EGL
    from OpenGL.EGL.EXT.platform_base import eglGetPlatformDisplayEXT

    display = eglGetPlatformDisplayEXT(SURFACELESS, None, None)
    EGL.eglInitialize(display, EGL.EGLint(), EGL.EGLint())
    EGL.eglBindAPI(EGL.EGL_OPENGL_API)
    # no attributes: a context with everything up to the newest compatible version, the fixed-function API too
    context = EGL.eglCreateContext(display, None, EGL.EGL_NO_CONTEXT, None)
    if not EGL.eglMakeCurrent(display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, context):
        raise RuntimeError("EGL made no context current")


def osmesa_context() -> None:
    """Off-screen Mesa; its own small buffer is not drawn to."""
    from OpenGL import GL, osmesa

    context = osmesa.OSMesaCreateContextExt(GL.GL_RGBA, 24, 0, 0, None)
    if not osmesa.OSMesaMakeCurrent(context, KEPT, GL.GL_UNSIGNED_BYTE, 8, 8):
        raise RuntimeError("OSMesa made no context current")


def keeper(window: str) -> Callable[[], None]:
    """Makes the context that is now current so again, whatever other libraries of the process have done meanwhile."""
    if window == "EGL":
        from OpenGL import EGL

        display, context = EGL.eglGetCurrentDisplay(), EGL.eglGetCurrentContext()
        return lambda: EGL.eglMakeCurrent(display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, context)
    from OpenGL import GL, osmesa

    kept = osmesa.OSMesaGetCurrentContext()
    return lambda: osmesa.OSMesaMakeCurrent(kept, KEPT, GL.GL_UNSIGNED_BYTE, 8, 8)


KEPT = (ctypes.c_ubyte * (4 * 8 * 8))()
"""OSMesa's buffer: it has to live as long as the context."""


def description() -> dict[str, str]:
    """Renderer, version and limits of the context."""
    from OpenGL import GL

    strings = {"opengl_vendor": GL.GL_VENDOR, "opengl_renderer": GL.GL_RENDERER, "opengl_version": GL.GL_VERSION}
    said = {name: GL.glGetString(which).decode() for name, which in strings.items()}
    return said | {"opengl_lights": str(int(GL.glGetIntegerv(GL.GL_MAX_LIGHTS)))}
