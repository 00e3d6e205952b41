"""Scene → ballcaster's own scene file. Pure: it runs without the renderer, so that its output can be tested as text."""

from __future__ import annotations

import json

from equilux.adapter import Case, Program


def translate(case: Case) -> Program:
    """Ballcaster reads JSON. The engine has already checked the features: only spheres and point lights arrive here."""
    scene = case.scene
    description = {
        "camera": {
            "eye": scene.camera.eye, "target": scene.camera.target, "up": scene.camera.up, "fov_y_deg": scene.camera.fov_y_deg,
        },
        "width": scene.film.width,
        "height": scene.film.height,
        "background": scene.background,
        "lights": [
            # Ballcaster has no attenuation coefficient: I / (d_q r²) is the light I / d_q under the inverse square.
            {"position": light.position, "intensity": [band / light.attenuation.quadratic for band in light.intensity]}
            for light in scene.lights.values()
        ],
        # K_diff is a BRDF in 1/sr. A renderer that takes an albedo ρ would be given ρ = π K_diff here.
        "balls": [
            {"center": ball.center, "radius": ball.radius, "brdf": scene.materials[ball.material].diffuse}
            for ball in scene.objects
        ],
    }
    return Program(files={"scene.json": json.dumps(description, indent=1).encode()}, entry="scene.json")
