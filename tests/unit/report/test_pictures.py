"""Packed pictures, thumbnails and colours: nothing is lost that matters."""

from __future__ import annotations

import base64
import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from equilux_report import colour, png, thumbnail
from equilux_report.pack import pack


def unpacked(script: str) -> dict[str, Any]:
    """What decode.js does, in numpy."""
    _, header, payload = json.loads("[" + script.strip().removeprefix("equiluxData(").removesuffix(");") + "]")
    count = header["width"] * header["height"]
    stored = np.frombuffer(zlib.decompress(base64.b64decode(payload)), np.uint8).reshape(header["stored"], 4, count)
    planes = np.ascontiguousarray(stored.transpose(0, 2, 1)).view("<f4").reshape(-1, header["height"], header["width"])
    return {name: planes[index] for name, index in header["planes"].items()}


@given(arrays(np.uint32, (3, 5, 7), elements=st.integers(0, 2**32 - 1)))
def test_packing_keeps_every_bit_of_any_float(bits: np.ndarray[Any, np.dtype[np.uint32]]) -> None:
    planes = dict(zip("RGB", bits.view(np.float32), strict=True))
    back = unpacked(pack("case/adapter", planes).script())
    for name, plane in planes.items():
        assert (back[name].view(np.uint32) == plane.view(np.uint32)).all()


def test_equal_bands_are_stored_once() -> None:
    plane = np.random.default_rng(1).random((40, 30), dtype=np.float32)
    grey = pack("k", {"R": plane, "G": plane.copy(), "B": plane.copy()})
    colour_ = pack("k", {"R": plane, "G": plane * 2, "B": plane * 3})
    assert json.loads(grey.header)["stored"] == 1
    assert len(colour_.payload) > 2 * len(grey.payload)


def test_negative_zero_and_zero_are_different_planes() -> None:
    zero = np.zeros((2, 2), np.float32)
    back = unpacked(pack("k", {"R": zero, "G": -zero, "B": zero}).script())
    assert np.signbit(back["G"]).all()
    assert not np.signbit(back["R"]).any()


def test_a_hostile_key_cannot_end_its_script_element() -> None:
    assert "<" not in pack("</script><b>", {"R": np.zeros((1, 1), np.float32)}).script()


def decoded(data: bytes, folder: Path) -> np.ndarray[Any, np.dtype[np.uint8]]:
    path = folder / "picture.png"
    path.write_bytes(data)
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8))


def test_png_is_read_back_by_someone_else_bit_for_bit(tmp_path: Path) -> None:
    pixels = np.random.default_rng(2).integers(0, 256, (13, 29, 3), dtype=np.uint8)
    assert (decoded(png.encode(pixels), tmp_path) == pixels).all()


def bands(image: np.ndarray[Any, np.dtype[np.float32]]) -> dict[str, Any]:
    return {band: image.copy() for band in "RGB"}


def test_one_nan_among_a_million_pixels_shows_in_the_thumbnail(tmp_path: Path) -> None:
    planes = bands(np.full((1000, 1000), 0.5, np.float32))
    planes["G"][777, 333] = np.nan
    shown = decoded(thumbnail.of_render(planes, 0.0), tmp_path)
    assert (shown == colour.NAN_COLOUR).all(axis=-1).sum() == 1


def test_one_diverging_pixel_among_a_million_shows_in_the_thumbnail(tmp_path: Path) -> None:
    planes = {f"en.{band}": np.full((1000, 1000), 0.01, np.float32) for band in "RGB"}
    planes["class"] = np.zeros((1000, 1000), np.float32)
    planes["en.B"][10, 20] = -500
    shown = decoded(thumbnail.of_normalised_error(planes), tmp_path).astype(int)
    assert (shown.max(axis=-1) > 115).sum() == 1
    assert shown[10 // 8, 20 // 8, 2] > shown[10 // 8, 20 // 8, 0], "negative is blue"


def test_edge_pixels_do_not_glow_in_the_thumbnail(tmp_path: Path) -> None:
    planes = {f"en.{band}": np.full((8, 8), 1e6, np.float32) for band in "RGB"}
    planes["class"] = np.full((8, 8), 2, np.float32)
    assert decoded(thumbnail.of_normalised_error(planes), tmp_path).max() < 115


def test_thumbnail_averages_light_and_not_its_encoding(tmp_path: Path) -> None:
    planes = bands(np.tile(np.array([[0.0, 1.0]], np.float32), (2, 128)))
    level = decoded(thumbnail.of_render(planes, 0.0), tmp_path)[0, 0, 0]
    assert level == 188, f"sRGB level of linear 0.5 is 188, got {level}"  # 127 would be the mean of the encoded levels


def test_exposure_brings_the_brightest_light_to_white() -> None:
    assert thumbnail.exposure_stops(bands(np.full((4, 4), 0.25, np.float32))) == 2.0
    assert thumbnail.exposure_stops(bands(np.zeros((4, 4), np.float32))) == 0.0
    assert thumbnail.exposure_stops(bands(np.full((4, 4), np.nan, np.float32))) == 0.0


def lightness(table: colour.Table) -> colour.Floats:
    """OKLab lightness of sRGB bytes."""
    c = table / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    to_lms = np.array([[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
                       [0.0883024619, 0.2817188376, 0.6299787005]])  # fmt: skip
    return np.asarray(np.cbrt(linear @ to_lms.T) @ [0.2104542553, 0.7936177850, -0.0040720468])


def test_false_colour_gets_lighter_with_every_step() -> None:
    steps = np.diff(lightness(colour.sequential())[::4])
    assert (steps > 0).all(), f"smallest step {steps.min():.4f}"


def test_diverging_colours_are_darkest_at_zero_and_equally_light_on_both_sides() -> None:
    table = lightness(colour.diverging())
    assert table.argmin() == 255
    gap = np.abs(table - table[::-1]).max()
    assert gap < 0.02, f"arms differ by {gap:.3f} in lightness"  # rounding to bytes and fitting the gamut


def test_colours_of_non_finite_values_are_far_from_every_map() -> None:
    maps = np.concatenate([colour.sequential(), colour.diverging(), np.repeat(np.arange(256)[:, None], 3, axis=1)]).astype(int)
    for paint in (colour.NAN_COLOUR, colour.PLUS_INF_COLOUR, colour.MINUS_INF_COLOUR):
        nearest = np.abs(maps - np.array(paint)).max(axis=1).min()
        assert nearest > 60, f"{paint} is {nearest} levels from a map's colour"


def test_heat_jumps_where_the_uncertainty_is_exceeded() -> None:
    inside, outside = colour.heat_position(np.array([1.0, np.nextafter(1.0, 2.0)]))
    assert outside - inside > 0.15
    positions = colour.heat_position(np.array([-1e9, -10.0, -0.5, 0.0, 0.5, 10.0, 1e9]))
    assert (np.diff(positions) > 0).all()
    assert positions[0] == -1
    assert positions[-1] == 1
