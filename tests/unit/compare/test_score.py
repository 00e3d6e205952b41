"""Judging an image that someone else rendered, from the file on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio
import pytest

from equilux import score
from equilux.complaint import BadUsage
from equilux.uncertainty import stated
from equilux_scenes.loader import corpus_folder, load_scene_file
from equilux_tracer import Tracer
from support.random_scenes import case_of

HEIGHT, WIDTH = 24, 32
CASE = case_of(
    {
        "equilux": 1,
        "name": "scored",
        "model": "phong",
        "camera": {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 30},
        "film": {"width": WIDTH, "height": HEIGHT},
        "background": [0.05, 0.1, 0.2],
        "lights": {"key": {"kind": "point", "position": [0.5, 2, 3], "intensity": [7, 6, 5]}},
        "materials": {"clay": {"diffuse": [0.6, 0.5, 0.4], "specular": [0.3, 0.3, 0.3], "exponent": 20, "emission": [0.02] * 3}},
        "objects": [{"kind": "sphere", "center": [0.1, 0, 0], "radius": 0.5, "material": "clay"}],
    }
)
TRUTH = Tracer(CASE).render()["radiance"]
assert 0 < TRUTH.min() < TRUTH.max() < 1


def write(
    path: Path, image: npt.NDArray[Any], number: Any = oiio.FLOAT, channels: tuple[str, ...] = ("R", "G", "B"), **attributes: Any
) -> Path:
    """Write an image with OpenImageIO, channel names and attributes as given."""
    if path.suffix == ".pfm":  # by hand: the definition says that the last row comes first
        path.write_bytes(b"PF\n%d %d\n-1.0\n" % (image.shape[1], image.shape[0]) + image[::-1].astype("<f4").tobytes())
        return path
    spec = oiio.ImageSpec(image.shape[1], image.shape[0], image.shape[2], number)
    spec.channelnames = channels
    for name, value in attributes.items():
        spec.attribute(name.replace("__", ":"), value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(np.ascontiguousarray(image.astype(np.float64))), output.geterror()
    output.close()
    return path


def verdict(path: Path, **options: Any) -> str:
    return str(score.score_image(CASE, path, **options).json["verdict"])


FORMATS = {
    "float.exr": oiio.FLOAT, "half.exr": oiio.HALF, "float.tif": oiio.FLOAT, "double.tif": oiio.DOUBLE, "half.tif": oiio.HALF,
    "sixteen.png": oiio.UINT16, "eight.png": oiio.UINT8, "eight.tif": oiio.UINT8, "long.tif": oiio.UINT, "shared.hdr": oiio.FLOAT,
    "bottom_up.pfm": oiio.FLOAT, "eight.ppm": oiio.UINT8,
}  # fmt: skip


@pytest.mark.parametrize("name", FORMATS)
def test_the_truth_agrees_in_every_format_within_what_the_format_costs(name: str, tmp_path: Path) -> None:
    path = write(tmp_path / name, TRUTH, FORMATS[name])
    foreign = score.read_image(path)
    error = np.abs(foreign.image - TRUTH)
    bound = stated(foreign.budget, foreign.image).bound(foreign.image)
    assert (error <= bound).all(), f"{name}: error {error.max()}, bound there {bound.ravel()[error.argmax()]}"
    assert verdict(path) == "agree"
    if not name.startswith("double"):
        used = float((error / bound).max())
        assert used > 0.1, f"{name}: only {used} of the stated bound is ever used"


@pytest.mark.parametrize("name", FORMATS)
def test_five_percent_too_bright_diverges_in_every_format(name: str, tmp_path: Path) -> None:
    assert verdict(write(tmp_path / name, TRUTH * 1.05, FORMATS[name])) == "diverge"


def test_what_the_renderer_leaves_uncertain_can_be_stated(tmp_path: Path) -> None:
    path = write(tmp_path / "image.exr", TRUTH * 1.001)
    assert verdict(path) == "diverge"
    assert verdict(path, rel=1.01e-3) == "agree"
    assert verdict(path, abs_=1.01e-3 * float(TRUTH.max())) == "agree"


def test_channels_are_found_by_name_and_alpha_is_left_aside(tmp_path: Path) -> None:
    alpha = np.full((HEIGHT, WIDTH, 1), 0.5)
    mixed = np.concatenate([alpha, TRUTH[..., ::-1], 7 * alpha], axis=2)
    path = write(tmp_path / "image.exr", mixed, channels=("A", "B", "G", "R", "Z"))
    pair = score.score_image(CASE, path).json
    assert pair["verdict"] == "agree"
    assert any("left aside" in note and "A" in note and "Z" in note for note in pair["notes"]), pair["notes"]


def test_an_alpha_in_a_png_does_not_multiply_the_bands(tmp_path: Path) -> None:
    with_alpha = np.concatenate([TRUTH, np.full((HEIGHT, WIDTH, 1), 0.25)], axis=2)
    path = write(tmp_path / "a.png", with_alpha, oiio.UINT16, ("R", "G", "B", "A"), oiio__UnassociatedAlpha=1)
    assert verdict(path) == "agree"


def test_channels_without_names_are_the_first_three(tmp_path: Path) -> None:
    path = write(tmp_path / "image.exr", TRUTH, channels=("x", "y", "z"))
    pair = score.score_image(CASE, path).json
    assert (pair["verdict"], pair["notes"]) == ("agree", ["the channels x, y, z are taken as R, G, B"])


def test_clipped_integers_are_said_to_be(tmp_path: Path) -> None:
    pair = score.score_image(CASE, write(tmp_path / "bright.png", TRUTH * 4, oiio.UINT16)).json
    assert pair["verdict"] == "diverge"
    assert any("may be clipped" in note for note in pair["notes"]), pair["notes"]


@pytest.mark.parametrize("name", ["image.jpg", "image.exr"])
def test_a_lossy_compression_is_said_to_be(name: str, tmp_path: Path) -> None:
    attributes = {"compression": "dwaa"} if name.endswith("exr") else {}
    path = write(tmp_path / name, TRUTH, oiio.FLOAT if attributes else oiio.UINT8, **attributes)
    assert any("loses precision" in note for note in score.read_image(path).notes)


@pytest.mark.parametrize(
    ("alter", "reason"),
    [
        (lambda image: np.full_like(image, np.nan), "pixels are invalid"),
        (lambda image: np.where(np.arange(WIDTH)[None, :, None] == 3, np.inf, image), "24 of 768 pixels are invalid"),
        (lambda image: np.where(np.arange(WIDTH)[None, :, None] == 3, -1.0, image), "negative beyond its own uncertainty"),
        (lambda image: np.zeros_like(image), "constant where the truth is not"),
        (lambda image: np.full_like(image, 0.2), "constant where the truth is not"),
        (lambda image: image[:-1], "differ in size: image is 32×23, oracle is 32×24"),
        (lambda image: image.transpose(1, 0, 2), "differ in size: image is 24×32"),
        (lambda image: image[:, ::-1], "pixels diverge"),
        (lambda image: image[::-1], "pixels diverge"),
        (lambda image: image[..., ::-1], "pixels diverge"),
        (lambda image: np.roll(image, 1, axis=1), "pixels diverge"),
    ],
    ids=["nan", "inf", "negative", "blank", "grey", "a row short", "transposed", "mirrored", "upside down", "bands", "moved"],
)
def test_spoilt_images_never_pass(alter: Any, reason: str, tmp_path: Path) -> None:
    pair = score.score_image(CASE, write(tmp_path / "image.exr", alter(TRUTH))).json
    assert pair["verdict"] == "diverge"
    assert reason in pair["reason"], pair["reason"]


@pytest.mark.parametrize("name", [*FORMATS, "image.jpg", "image.npy"])
def test_an_image_cut_short_anywhere_never_passes(name: str, tmp_path: Path) -> None:
    whole, cut = tmp_path / name, tmp_path / f"cut-{name}"
    if name.endswith("npy"):
        np.save(whole, TRUTH)
    else:
        write(whole, TRUTH, FORMATS.get(name, oiio.UINT8))
    data = whole.read_bytes()
    for share in (0.0, 0.02, 0.1, 0.4, 0.7, 0.95, 0.999):
        cut.write_bytes(data[: min(int(len(data) * share), len(data) - 1)])
        try:
            outcome = verdict(cut)
        except BadUsage as problem:
            outcome = str(problem)
        refused = str(cut) in outcome and "\n" not in outcome
        assert refused or outcome == "diverge", f"{name} cut to {share} of its length: {outcome}"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.exr", None, "no such file: '.*gone.exr'"),
        ("text.exr", b"not a picture", "text.exr' cannot be read: "),
        ("empty.png", b"", "empty.png' cannot be read: "),
        ("what.xyz", b"not a picture", "what.xyz' cannot be read: "),
        ("text.npy", b"not an array", "text.npy' cannot be read: "),
    ],
)
def test_a_file_that_is_no_image_is_told_by_name(name: str, content: bytes | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadUsage, match=message):
        score.read_image(path)


def test_a_folder_is_no_image(tmp_path: Path) -> None:
    with pytest.raises(BadUsage, match="no such file"):
        score.read_image(tmp_path)


def test_pictures_that_do_not_cover_the_film_or_have_too_few_bands_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadUsage, match="has the channels Y, allowed R, G, B or three at least"):
        score.read_image(write(tmp_path / "grey.exr", TRUTH[..., :1], channels=("Y",)))
    spec = oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT)
    spec.full_width, spec.full_height, spec.x = WIDTH * 2, HEIGHT, 3
    output = oiio.ImageOutput.create("x.exr")
    assert output.open(str(tmp_path / "crop.exr"), spec)
    output.write_image(np.ascontiguousarray(TRUTH.astype(np.float32)))
    output.close()
    with pytest.raises(BadUsage, match=r"data window 32×24 at \(3, 0\), allowed the display window, 64×24 at \(0, 0\)"):
        score.read_image(tmp_path / "crop.exr")
    with pytest.raises(BadUsage, match="orientation 3, allowed 1"):
        score.read_image(write(tmp_path / "turned.tif", TRUTH, Orientation=3))


@pytest.mark.parametrize(("dtype", "expected"), [(np.float64, "agree"), (np.float32, "agree"), (np.float16, "agree")])
def test_numpy_arrays_are_judged_like_files(dtype: Any, expected: str, tmp_path: Path) -> None:
    np.save(tmp_path / "image.npy", TRUTH.astype(dtype))
    assert verdict(tmp_path / "image.npy") == expected
    np.save(tmp_path / "image.npy", (TRUTH * 1.01).astype(dtype))
    assert verdict(tmp_path / "image.npy") == "diverge"


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((4, 4)), r"shape \(4, 4\), allowed \(height, width, 3\)"),
        (np.zeros((0, 4, 3)), r"shape \(0, 4, 3\)"),
        (np.zeros((4, 4, 3), np.int64), "holds int64, allowed float16, float32 or float64"),
        (np.zeros((4, 4, 3), object), "cannot be read"),
    ],
)
def test_arrays_that_are_no_image_are_refused(array: npt.NDArray[Any], message: str, tmp_path: Path) -> None:
    np.save(tmp_path / "image.npy", array)
    with pytest.raises(BadUsage, match=message):
        score.read_image(tmp_path / "image.npy")


def test_the_truth_is_the_oracle_and_the_tracer_where_there_is_no_closed_form(tmp_path: Path) -> None:
    path = write(tmp_path / "image.exr", TRUTH)
    assert score.score_image(CASE, path).json["b"] == "oracle"
    assert score.truth_of(CASE, Tracer(CASE)).adapter == "oracle"
    (mesh,) = load_scene_file(corpus_folder() / "meshes" / "mesh-flat.scene.yaml").cases
    truth = score.truth_of(mesh, Tracer(mesh))
    assert truth.adapter == "reference"
    assert score.score_image(mesh, write(tmp_path / "mesh.exr", truth.image)).json["verdict"] == "agree"
