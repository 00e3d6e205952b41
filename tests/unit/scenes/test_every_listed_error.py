"""Every violation that the contract of the spec lists, each at its exact line and column and alone."""

from __future__ import annotations

from collections.abc import Callable

import pytest

Edited = Callable[..., str]
Only = Callable[..., str]

# (what is replaced, by what: « marks the place of the error, and the message)
VALUES = {
    "nan": ("radius: 0.5", "radius: «.nan", "radius of object 0 (sphere): got .nan, allowed a number > 0"),
    "inf": ("fov_y_deg: 30", "fov_y_deg: «.inf", "fov_y_deg of camera: got .inf, allowed a number in the open interval (0, 180)"),
    "overflow": ("exponent: 4}", "exponent: «1e400}", "exponent of light 'lamp': got 1e400, allowed a number ≥ 0"),
    "long integer": (
        "exponent: 4}",
        "exponent: «" + 400 * "9" + "}",
        f"exponent of light 'lamp': got {59 * '9'}…, allowed a number ≥ 0",
    ),
    "nan in a vector": ("eye: [0, 0, 3]", "eye: [0, «.NaN, 3]", "eye[1] of camera: got .NaN, allowed a finite number"),
    "inf in a band": ("[7.5, 7.5, 7.5]", "[7.5, 7.5, «-.inf]", "intensity[2] of light 'key': got -.inf, allowed a number ≥ 0"),
    "nan in a mesh": (
        "[1, 0, 0], [0, 1, 0]]\n",
        "[1, «.nan, 0], [0, 1, 0]]\n",
        "vertices[1][1] of object 6 (mesh): got .nan, allowed a finite number",
    ),
    "negative coefficient": (
        "diffuse: [0.6, 0.6",
        "diffuse: [«-0.6, 0.6",
        "diffuse[0] of material 'clay': got -0.6, allowed a number ≥ 0",
    ),
    "negative specular": (
        "specular: 0.5",
        "specular: «-0.5",
        "specular of material 'clay': got -0.5, allowed one number ≥ 0 or three",
    ),
    "negative ambient": (
        "ambient: 0.1,",
        "ambient: «-0.1,",
        "ambient of material 'clay': got -0.1, allowed one number ≥ 0 or three",
    ),
    "negative emission": (
        "emission: 0.01",
        "emission: «-1",
        "emission of material 'clay': got -1, allowed one number ≥ 0 or three",
    ),
    "negative radiance": (
        "background: 0.25",
        "background: «-0.25",
        "background of the scene: got -0.25, allowed one number ≥ 0 or three",
    ),
    "negative scene ambient": ("[0.1, 0.2, 0.3]", "[0.1, «-0.2, 0.3]", "ambient[1] of the scene: got -0.2, allowed a number ≥ 0"),
    "negative intensity": (
        "intensity: 5",
        "intensity: «-5",
        "intensity of light 'lamp': got -5, allowed one number ≥ 0 or three",
    ),
    "negative irradiance": (
        "irradiance: 1",
        "irradiance: «-1",
        "irradiance of light 'sun': got -1, allowed one number ≥ 0 or three",
    ),
    "negative attenuation": ("linear: 0", "linear: «-1", "linear of attenuation of light 'key': got -1, allowed a number ≥ 0"),
    "negative exponent": ("exponent: 20", "exponent: «-20", "exponent of material 'clay': got -20, allowed a number ≥ 0"),
    "negative spot exponent": ("exponent: 4}", "exponent: «-4}", "exponent of light 'lamp': got -4, allowed a number ≥ 0"),
    "transparency above 1": (
        "emission: 0.01",
        "transparency: «1.5",
        "transparency of material 'clay': got 1.5, allowed a number in [0, 1]",
    ),
    "transparency below 0": (
        "emission: 0.01",
        "transparency: «-0.5",
        "transparency of material 'clay': got -0.5, allowed a number in [0, 1]",
    ),
    "ior 0": ("emission: 0.01", "ior: «0", "ior of material 'clay': got 0, allowed a number > 0"),
    "radius 0": ("radius: 0.5", "radius: «0", "radius of object 0 (sphere): got 0, allowed a number > 0"),
    "radius underflows": ("radius: 0.5", "radius: «1e-400", "radius of object 0 (sphere): got 1e-400, allowed a number > 0"),
    "disc radius": ("radius: 1,", "radius: «-1,", "radius of object 3 (disc): got -1, allowed a number > 0"),
    "cylinder radius": ("radius: 0.3", "radius: «0", "radius of object 5 (cylinder): got 0, allowed a number > 0"),
    "height_m 0": (
        "perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30",
        "orthographic, eye: [0, 0, 3], target: [0, 0, 0], height_m: «0",
        "height_m of camera: got 0, allowed a number > 0",
    ),
    "fov 0": ("fov_y_deg: 30", "fov_y_deg: «0", "fov_y_deg of camera: got 0, allowed a number in the open interval (0, 180)"),
    "fov 180": (
        "fov_y_deg: 30",
        "fov_y_deg: «180",
        "fov_y_deg of camera: got 180, allowed a number in the open interval (0, 180)",
    ),
    "cone 0": ("_deg: 20", "_deg: «0", "cone_half_angle_deg of light 'lamp': got 0, allowed a number in the interval (0, 90]"),
    "cone above 90": (
        "_deg: 20",
        "_deg: «90.5",
        "cone_half_angle_deg of light 'lamp': got 90.5, allowed a number in the interval (0, 90]",
    ),
    "width 0": ("width: 64", "width: «0", "width of film: got 0, allowed an integer ≥ 1"),
    "width with a fraction": ("width: 64", "width: «64.5", "width of film: got 64.5, allowed an integer ≥ 1"),
    "height a float": ("height: 48", "height: «48.0", "height of film: got 48.0, allowed an integer ≥ 1"),
    "height true": ("height: 48", "height: «true", "height of film: got true, allowed an integer ≥ 1"),
    "recursion_limit negative": (
        "background: 0.25",
        "recursion_limit: «-1",
        "recursion_limit of the scene: got -1, allowed an integer ≥ 0",
    ),
    "recursion_limit 1.5": (
        "background: 0.25",
        "recursion_limit: «1.5",
        "recursion_limit of the scene: got 1.5, allowed an integer ≥ 0",
    ),
    "zero direction": (
        "sun: {kind: directional, direction: [0, -1, 0]",
        "sun: {kind: directional, direction: «[0, 0, 0]",
        "direction of light 'sun': got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "zero spot direction": (
        "position: [0, 2, 0], direction: [0, -1, 0]",
        "position: [0, 2, 0], direction: «[0, -0.0, 0]",
        "direction of light 'lamp': got [0, -0.0, 0], allowed three numbers, not all 0",
    ),
    "zero plane normal": (
        "point: [0, -0.5, 0], normal: [0, 1, 0]",
        "point: [0, -0.5, 0], normal: «[0, 0, 0]",
        "normal of object 1 (plane): got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "zero up": ("up: [0, 1, 0]", "up: «[0, 0, 0]", "up of camera: got [0, 0, 0], allowed three numbers, not all 0"),
    "zero vertex normal": (
        "[0, 0, 2]",
        "«[0, 0, 0]",
        "vertex_normals[1] of object 6 (mesh): got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "zero axis": (
        "axis: [0, 1, 0]",
        "axis: «[0, 0, 0]",
        "axis of rotate of transform step 1 of object 6: got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "zero scale": (
        "scale: 2",
        "scale: «0",
        "scale of transform step 0 of object 6: got 0, allowed one number or three, none of them 0",
    ),
    "zero in a scale": (
        "scale: 2",
        "scale: «[1, 0, 1]",
        "scale of transform step 0 of object 6: got [1, 0, 1], allowed one number or three, none of them 0",
    ),
    "zero edge": (
        "edge_u: [1, 0, 0]",
        "edge_u: «[0, 0, 0]",
        "edge_u of object 4 (rectangle): got [0, 0, 0], allowed three numbers, not all 0",
    ),
    "eye = target": (
        "target: [0, 0, 0]",
        "target: «[0, 0, 3]",
        "target of camera: got [0, 0, 3], allowed another point than the eye",
    ),
    "up along the view": (
        "up: [0, 1, 0]",
        "up: «[0, 0, -7]",
        "up of camera: got [0, 0, -7], allowed a direction not parallel to the view",
    ),
    "undefined material": (
        "radius: 0.5, material: clay",
        "radius: 0.5, material: «clya",
        "material of object 0 (sphere): got 'clya', allowed clay (did you mean 'clay'?)",
    ),
    "unknown cause": (
        "cause: exponent-clamped",
        "cause: «exponent-clampd",
        "cause of expectation 0: got 'exponent-clampd', allowed a known cause id (did you mean 'exponent-clamped'?)",
    ),
    "sweep without values": (
        "values: [1, 10, 100, 1000]",
        "values: «[]",
        "values of sweep axis 'exponent': got [], allowed a list of at least one value",
    ),
    "sweep of nothing": (
        "path: materials.clay.exponent",
        "path: «materials.clay.exponant",
        "path of a sweep axis: got 'materials.clay.exponant', allowed one of diffuse, specular, exponent, "
        "ambient, emission, brdf, reflection, "
        "transmission, transparency, ior after 'materials.clay', not 'exponant' (did you mean 'exponent'?)",
    ),
    "unknown key": ("specular: 0.5", "«specullar: 0.5", "unknown key 'specullar' in material 'clay' (did you mean 'specular'?)"),
    "unknown key in the scene": (
        "background: 0.25",
        "«backgruond: 0.25",
        "unknown key 'backgruond' in the scene (did you mean 'background'?)",
    ),
    "unknown key in a light": (
        "irradiance: 1",
        "irradiance: 1, «zzz: 1",
        "unknown key 'zzz' in light 'sun', "
        "allowed spectrum, ambient, diffuse, specular, kind, direction, irradiance, illuminance",
    ),
    "unknown object kind": (
        "kind: sphere",
        "kind: «shpere",
        "kind of object 0: got 'shpere', allowed sphere, plane, box, disc, rectangle, cylinder, mesh (did you mean 'sphere'?)",
    ),
    "unknown light kind": (
        "kind: point",
        "kind: «pont",
        "kind of light 'key': got 'pont', allowed point, directional, spot (did you mean 'point'?)",
    ),
    "unknown projection": (
        "projection: perspective",
        "projection: «perspectiv",
        "projection of camera: got 'perspectiv', allowed perspective, orthographic (did you mean 'perspective'?)",
    ),
    "unknown model": (
        "model: phong",
        "model: «phnog",
        "model of the scene: got 'phnog', allowed phong or opengl or raytraced or reflection-equation (did you mean 'phong'?)",
    ),
    "spec version 2": ("equilux: 1", "equilux: «2", "equilux of the scene: got 2, allowed 1, the version of the spec language"),
    "spec version true": (
        "equilux: 1",
        "equilux: «true",
        "equilux of the scene: got true, allowed 1, the version of the spec language",
    ),
    "spec version 1.0": (
        "equilux: 1",
        "equilux: «1.0",
        "equilux of the scene: got 1.0, allowed 1, the version of the spec language",
    ),
    "duplicate key": ("specular: 0.5", "specular: 0.5, «specular: 0.5", "duplicate key 'specular', first given at 18:36"),
    "duplicate name": ("  sun: {", "  «key: {", "duplicate key 'key', first given at 10:3"),
    "tag": (
        "radius: 0.5",
        "radius: «!!float 0.5",
        "YAML tag 'tag:yaml.org,2002:float', allowed no tags (values are typed by the spec)",
    ),
    "python tag": (
        "up: [0, 1, 0]",
        "up: «!!python/tuple [0, 1, 0]",
        "YAML tag 'tag:yaml.org,2002:python/tuple', allowed no tags (values are typed by the spec)",
    ),
    "name with capitals": (
        "name: every-part",
        "name: «Every-part",
        "name of the scene: got 'Every-part', allowed 1 to 100 of a to z, 0 to 9 and -",
    ),
    "empty name": ("name: every-part", "name: «''", "name of the scene: got '', allowed 1 to 100 of a to z, 0 to 9 and -"),
    "name with a line end": (
        "name: every-part",
        'name: «"every-part\\n"',
        "name of the scene: got 'every-part\\n', allowed 1 to 100 of a to z, 0 to 9 and -",
    ),
    "box turned over": (
        "max: [1, 2, 3]",
        "max: [1, «-2, 3]",
        "max[1] of object 2 (box): got -2, allowed a number > -2, which is min[1]",
    ),
    "cylinder without length": (
        "top: [0, 1, 0]",
        "top: «[0, 0, 0]",
        "top of object 5 (cylinder): got [0, 0, 0], allowed another point than the base",
    ),
    "skew rectangle": (
        "edge_v: [0, 1, 0]",
        "edge_v: «[1, 1, 0]",
        "edge_v of object 4 (rectangle): got [1, 1, 0], allowed an edge orthogonal to edge_u (it makes 45° with it)",
    ),
    "light infinitely bright": (
        "{constant: 0, linear: 0, quadratic: 1}",
        "«{constant: 0}",
        "attenuation of light 'key': got {constant: 0}, allowed at least one term > 0 (the light would be infinitely bright)",
    ),
    "step of two kinds": (
        "{scale: 2}",
        "«{scale: 2, translate: [0, 0, 1]}",
        "transform step 0 of object 6: got {scale: 2, translate: [0, 0, 1]}, "
        "allowed exactly one of scale, rotate, translate, matrix",
    ),
    "step of no kind": (
        "{scale: 2}",
        "«{}",
        "transform step 0 of object 6: got {}, allowed exactly one of scale, rotate, translate, matrix",
    ),
    "matrix of three rows": (
        "{scale: 2}",
        "{matrix: «[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}",
        "matrix of transform step 0 of object 6: got [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], "
        "allowed four rows of four numbers",
    ),
    "matrix row of three": (
        "{scale: 2}",
        "{matrix: [[1, 0, 0, 0], «[0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}",
        "matrix[1] of transform step 0 of object 6: got [0, 1, 0], allowed four numbers",
    ),
    "projective matrix": (
        "{scale: 2}",
        "{matrix: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], «[0, 0, 1, 1]]}",
        "matrix[3] of transform step 0 of object 6: got [0, 0, 1, 1], allowed [0, 0, 0, 1] as the last row (points stay points)",
    ),
    "singular transform": (
        "[{scale: 2}, {rotate",
        "«[{matrix: [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}, {rotate",
        "transform of object 6 (mesh): got [{matrix: [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0,…, "
        "allowed a transform that can be undone (this one flattens the object)",
    ),
    "transform that overflows": (
        "[{scale: 2}, {rotate",
        "«[{scale: 1e200}, {scale: 1e200}, {rotate",
        "transform of object 6 (mesh): got [{scale: 1e200}, {scale: 1e200}, {rotate: {axis: [0, 1, 0],…, "
        "allowed steps whose product stays finite",
    ),
    "mesh of file and faces": (
        "  - kind: mesh\n",
        "  - «file: a.ply\n    kind: mesh\n",
        "object 6 (mesh): got {file: 'a.ply', kind: 'mesh', normals: 'smooth', vertices: …, "
        "allowed either file or vertices and faces, not both",
    ),
    "face out of range": ("faces: [[0, 1, 2]]", "faces: [[0, 1, «3]]", "faces[0][2] of object 6 (mesh): got 3, allowed 0 to 2"),
    "negative face": (
        "faces: [[0, 1, 2]]",
        "faces: [[0, «-1, 2]]",
        "faces[0][1] of object 6 (mesh): got -1, allowed an integer ≥ 0",
    ),
    "no face": (
        "faces: [[0, 1, 2]]",
        "faces: «[]",
        "faces of object 6 (mesh): got [], allowed a list of at least one triangle, three vertex numbers each",
    ),
    "face of four": (
        "faces: [[0, 1, 2]]",
        "faces: [«[0, 1, 2, 0]]",
        "faces[0] of object 6 (mesh): got [0, 1, 2, 0], allowed three vertex numbers",
    ),
    "list for a mapping": ("film: {width: 64, height: 48}", "film: «[64, 48]", "film: got [64, 48], allowed a mapping"),
    "text for a number": ("radius: 0.5", "radius: «'0.5'", "radius of object 0 (sphere): got '0.5', allowed a number > 0"),
    "number for text": ("about: Every kind of part once.", "about: «7", "about of the scene: got 7, allowed text"),
    "two numbers for three": (
        "point: [0, -0.5, 0]",
        "point: «[0, -0.5]",
        "point of object 1 (plane): got [0, -0.5], allowed three numbers",
    ),
    "four bands": (
        "[0.6, 0.6, 0.6]",
        "«[0.6, 0.6, 0.6, 1]",
        "diffuse of material 'clay': got [0.6, 0.6, 0.6, 1], allowed one number ≥ 0 or three",
    ),
    "null": ("radius: 0.5", "radius: «~", "radius of object 0 (sphere): got nothing, allowed a number > 0"),
    "yes for true": ("capped: true", "capped: «yes", "capped of object 5 (cylinder): got 'yes', allowed true or false"),
    "unfinished when": (
        'when: "exponent > 128"',
        'when: "exponent > 128 and«"',
        "when of expectation 0: got the end, allowed the name of a sweep axis (AXIS < <= > >= == != NUMBER, joined by and, or)",
    ),
    "when of an unknown axis": (
        'when: "exponent > 128"',
        'when: "«exponnt > 128"',
        "when of expectation 0: unknown sweep axis 'exponnt', allowed exponent (did you mean 'exponent'?)",
    ),
    "when as code": (
        'when: "exponent > 128"',
        'when: "exponent > «__import__"',
        "when of expectation 0: got '__import__', allowed a number (AXIS < <= > >= == != NUMBER, joined by and, or)",
    ),
}


@pytest.mark.parametrize(("old", "new", "message"), VALUES.values(), ids=VALUES)
def test_a_violation_is_reported_once_at_its_place(only_error: Only, edited: Edited, old: str, new: str, message: str) -> None:
    assert only_error(edited(old, new)) == message


# (edits, and the message): what is not written has no place of its own, the error stands at the part that lacks it
LACKING = {
    "up": (
        ("camera: {", "camera: «{", "eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0]", "eye: [0, 3, 0], target: [0, 0, 0]"),
        "up of camera: not given, allowed a direction not parallel to the view (give 'up')",
    ),
    "faces": (
        ("  - kind: mesh", "  - «kind: mesh", "    faces: [[0, 1, 2]]\n", ""),
        "object 6 (mesh): got {kind: 'mesh', normals: 'smooth', vertices: [[0, 0, 0], [1,…, "
        "allowed either file, or vertices and faces (faces missing)",
    ),
    "one normal": (
        ("vertex_normals: [[", "vertex_normals: «[[", "[0, 0, 2], [0, 0, 3]]", "[0, 0, 2]]"),
        "vertex_normals of object 6 (mesh): got [[0, 0, 1], [0, 0, 2]], allowed one per vertex, 3 (2 given)",
    ),
    "one attenuation term": (
        ("attenuation: {constant: 0, linear: 0, quadratic: 1}", "attenuation: «{}"),
        "attenuation of light 'key': got {}, allowed at least one term > 0 (the light would be infinitely bright)",
    ),
}


@pytest.mark.parametrize(("edits", "message"), LACKING.values(), ids=LACKING)
def test_what_is_not_written_is_reported_at_its_part(
    only_error: Only, edited: Edited, edits: tuple[str, ...], message: str
) -> None:
    assert only_error(edited(*edits)) == message


MISSING = {
    "camera": (
        "camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}\n",
        "the scene, allowed a mapping",
    ),
    "film": ("film: {width: 64, height: 48}\n", "the scene, allowed a mapping"),
    "equilux": ("equilux: 1\n", "the scene, allowed 1, the version of the spec language"),
    "model": ("model: phong\n", "the scene, allowed phong or opengl or raytraced or reflection-equation"),
    "name": ("name: every-part\n", "the scene, allowed 1 to 100 of a to z, 0 to 9 and -"),
}


@pytest.mark.parametrize("key", MISSING)
def test_a_missing_key_of_the_scene_is_reported_at_its_start(only_error: Only, edited: Edited, key: str) -> None:
    line, words = MISSING[key]
    assert only_error("«" + edited(line, "")) == f"missing key '{key}' in {words}"


def test_missing_objects_are_reported(only_error: Only, valid: str) -> None:
    text = valid[: valid.index("objects:")] + valid[valid.index("sweep:") :]
    assert only_error("«" + text) == "missing key 'objects' in the scene, allowed a list"


def test_a_missing_key_of_a_part_is_reported_at_the_part(only_error: Only, edited: Edited) -> None:
    text = edited("{kind: sphere, center: [0, 0, 0], radius: 0.5,", "«{kind: sphere, center: [0, 0, 0],")
    assert only_error(text) == "missing key 'radius' in object 0 (sphere), allowed a number > 0"


def test_a_missing_kind_is_reported_with_the_kinds_there_are(only_error: Only, edited: Edited) -> None:
    text = edited("{kind: directional, direction", "«{direction")
    assert only_error(text) == "missing key 'kind' in light 'sun', allowed point, directional, spot"


# term → (edit, where it stands, what is written, its default, the model that has it)
FOREIGN = {
    "reflection": ("emission: 0.01", "reflection: «[0.5, 0.5, 0.5]", "material 'clay'", "[0.5, 0.5, 0.5]", "0", "raytraced"),
    "transmission": ("emission: 0.01", "transmission: «0.5", "material 'clay'", "0.5", "0", "raytraced"),
    "transparency": ("emission: 0.01", "transparency: «0.5", "material 'clay'", "0.5", "0", "raytraced"),
    "ior": ("emission: 0.01", "ior: «1.5", "material 'clay'", "1.5", "1", "raytraced"),
    "recursion_limit": ("background: 0.25", "recursion_limit: «3", "the scene", "3", "8", "raytraced"),
    "transparent_shadows": (
        "background: 0.25",
        "transparent_shadows: «ignore",
        "the scene",
        "'ignore'",
        "attenuate",
        "raytraced",
    ),
    "viewer": ("background: 0.25", "viewer: «infinite", "the scene", "'infinite'", "local", "opengl"),
    "ambient": ("irradiance: 1", "irradiance: 1, ambient: «0.5", "light 'sun'", "0.5", "0", "opengl"),
    "diffuse": ("irradiance: 1", "irradiance: 1, diffuse: «[1, 1, 0.5]", "light 'sun'", "[1, 1, 0.5]", "1", "opengl"),
    "specular": ("intensity: 5", "intensity: 5, specular: «0", "light 'lamp'", "0", "1", "opengl"),
}


@pytest.mark.parametrize("term", FOREIGN)
def test_a_term_of_another_model_is_an_error_that_says_which_model_has_it(only_error: Only, edited: Edited, term: str) -> None:
    old, new, part, got, default, model = FOREIGN[term]
    expected = f"{term} of {part}: got {got}, allowed only its default, {default}, in a 'phong' scene"
    assert only_error(edited(old, new)) == f"{expected} (the model '{model}' has this term)"


def test_terms_of_other_models_at_their_defaults_are_accepted(load: Callable[..., object], edited: Edited) -> None:
    load(
        edited(
            "background: 0.25",
            "background: 0.25\nrecursion_limit: 8\ntransparent_shadows: attenuate\nviewer: local",
            "emission: 0.01",
            "reflection: [0, 0, 0], transmission: 0, transparency: 0, ior: 1",
            "irradiance: 1",
            "irradiance: 1, ambient: 0, diffuse: 1, specular: [1, 1, 1.0]",
        )
    )


EMITTERS = {
    "sphere": "center: [0, 0, 0], radius: 1",
    "disc": "center: [0, 0, 0], normal: [0, 1, 0], radius: 1",
    "rectangle": "corner: [0, 0, 0], edge_u: [1, 0, 0], edge_v: [0, 1, 0]",
    "environment": "",
}


@pytest.mark.parametrize("model", ["phong", "opengl", "raytraced"])
@pytest.mark.parametrize("kind", EMITTERS)
def test_an_emitter_outside_its_model_is_an_error_that_says_which_model_has_it(
    only_error: Only, edited: Edited, kind: str, model: str
) -> None:
    light = f"{{kind: «{kind}, radiance: 1{', ' * bool(EMITTERS[kind])}{EMITTERS[kind]}}}"
    text = edited("model: phong", f"model: {model}", "lights:\n", f"lights:\n  glow: {light}\n", "1, 10, 100, 1000", "1, 10, 100")
    scene = f"{'an' if model == 'opengl' else 'a'} '{model}' scene"
    expected = f"kind of light 'glow': got '{kind}', allowed point, directional, spot in {scene}"
    assert only_error(text) == f"{expected} (the model 'reflection-equation' has this kind)"


def test_a_misspelt_kind_is_compared_with_the_kinds_of_the_model(only_error: Only, edited: Edited) -> None:
    pairs = ("model: phong", "model: reflection-equation", "ambient: [0.1, 0.2, 0.3]\n", "", "ambient: 0.1,", "")
    text = edited(*pairs, "kind: directional", "kind: «environmnt")
    expected = "allowed point, directional, spot, sphere, disc, rectangle, environment (did you mean 'environment'?)"
    assert only_error(text) == f"kind of light 'sun': got 'environmnt', {expected}"
