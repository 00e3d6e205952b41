"""Judging an image that someone else rendered: reading it, what its file format leaves uncertain, and the comparison with the
truth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

from equilux.adapter import Bound, Budget, Image
from equilux.compare import PairResult, Reference, RenderedImage, compare_pair
from equilux.complaint import BadUsage
from equilux.trust import TRUTHS
from equilux.uncertainty import stated

if TYPE_CHECKING:
    from equilux_scenes.case import Case

NAME = "image"
"""What the judged image is called in the pair, in an adapter's place."""

INTEGERS = {"uint8": (oiio.UINT8, 255), "uint16": (oiio.UINT16, 65535), "uint": (oiio.UINT, 4294967295)}
"""Number type → OpenImageIO's name of it and its largest value, which stands for 1 W/(m²·sr)."""
FLOATS = ("half", "float", "double")
EXACT_COMPRESSIONS = ("", "none", "rle", "zip", "zips", "piz", "lzw", "packbits", "deflate", "ccittrle", "zstd")
LOSSY_FORMATS = ("jpeg", "jpeg2000", "jpegxl", "webp", "heif")
PNG_END = b"IEND\xaeB`\x82"


@dataclass(frozen=True)
class ForeignImage:
    """image: (h, w, 3) linear radiance, row 0 on top, float32 or float64. budget: what the file format alone leaves
    uncertain. notes: what was left aside or assumed in reading it, one sentence each.
    """

    image: Image
    budget: Budget
    notes: tuple[str, ...] = ()


def score_image(
    case: Case, path: Path, *, abs_: float = 0.0, rel: float = 0.0,
    truth: RenderedImage | None = None, tracer: Reference | None = None, diagnose_within_s: float | None = None,
) -> PairResult:  # fmt: skip
    """Judge an image file against the truth of a case, as any pair is judged.

    abs_, rel: what its renderer leaves uncertain beyond the file format: |error| ≤ abs_ + rel |L|. truth: by default the
    closed form where the case has one, else the reference tracer. The JSON is that of `compare_pair`, with "notes" from the
    reading. diagnose_within_s: if it diverges, look for the causes for as many seconds, and put them and the share that they
    explain into "causes" and "explained"; None: do not. An image of the wrong size diverges with that reason. Raises BadUsage
    for a file that is no whole image of three bands.
    """
    if tracer is None:
        from equilux_tracer import Tracer

        tracer = Tracer(case)
    foreign = read_image(path)
    own = (Bound("stated", "stated by whoever asks", abs=abs_, rel=rel),) if abs_ or rel else ()
    uncertainty = stated(Budget((*foreign.budget.terms, *own)), foreign.image)
    side = RenderedImage(NAME, foreign.image, uncertainty, truth_rank=len(TRUTHS))
    truth = truth or truth_of(case, tracer)
    result = compare_pair(side, truth, tracer)
    result.json["notes"] = list(foreign.notes)
    if diagnose_within_s is not None and result.json["verdict"] == "diverge" and result.json["diverge"]:
        from equilux.diagnose import search

        found = search.diagnose(case, side, truth, result, restate=None, time_limit_s=diagnose_within_s)
        result.json["explained"] = found.explained
        result.json["causes"] = [cause.model_dump(mode="json") for cause in found.causes]
    return result


def truth_of(case: Case, tracer: Any) -> RenderedImage:
    """The oracle's picture of a case with its arithmetic's bound; the tracer's where some feature has no closed form."""
    import equilux_oracle

    if not equilux_oracle.supports(case):
        adapter, (image, bound) = "oracle", equilux_oracle.radiance_with_bound(case)
    else:
        arrays = tracer.render(("radiance", "rounding"))
        adapter, image, bound = "reference", arrays["radiance"], arrays["rounding"]
    return RenderedImage(adapter, image, stated(Budget((Bound("arithmetic", "rounding of the evaluation", abs=bound),)), image))


def read_image(path: Path) -> ForeignImage:
    """Read what someone else rendered: any file that OpenImageIO reads, or a NumPy array .npy of shape (height, width, 3).

    The channels R, G, B are taken, or else the first three; others (alpha) are left aside. Integers are taken as linear, the
    largest as 1. Raises BadUsage for a file that is missing, damaged, cut short, of fewer than three channels or of unknown
    number type.
    """
    if not path.is_file():
        raise BadUsage(f"no such file: '{path}'")
    return _read_array(path) if path.suffix == ".npy" else _read_picture(path)


def _read_array(path: Path) -> ForeignImage:
    try:
        image = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as problem:
        raise BadUsage(f"'{path}' cannot be read: {problem}") from problem
    if not isinstance(image, np.ndarray) or image.ndim != 3 or image.shape[2] != 3 or image.size == 0:
        raise BadUsage(f"'{path}' holds an array of shape {np.shape(image)}, allowed (height, width, 3)")
    if image.dtype == np.float16:
        return ForeignImage(image.astype(np.float32), Budget((_half(image.astype(np.float64)),)))
    if image.dtype not in (np.float32, np.float64):
        raise BadUsage(f"'{path}' holds {image.dtype}, allowed float16, float32 or float64")
    return ForeignImage(np.ascontiguousarray(image), Budget())


def _read_picture(path: Path) -> ForeignImage:
    as_stored = oiio.ImageSpec()
    as_stored.attribute("oiio:UnassociatedAlpha", 1)  # else the bands would be multiplied by an alpha that is then left aside
    as_stored.attribute("pnm:pfmflip", 1)  # PFM has its last row first; OpenImageIO 3.2 turns it only when asked
    source = oiio.ImageInput.open(str(path), as_stored)
    if source is None:
        raise BadUsage(f"'{path}' cannot be read: {_one_line(oiio.geterror())}")
    try:
        spec, kind = source.spec(), source.format_name()
        _refuse_what_is_no_film(path, spec)
        bands = _bands(path, spec)
        numbers = [str(spec.channelformat(band)) for band in bands]
        pixels = _pixels(source, numbers)
        error = _one_line(source.geterror())
    finally:
        source.close()
    if pixels is None or error:
        raise BadUsage(f"'{path}' cannot be read: {error or 'it ends too early'}")
    if kind == "png" and PNG_END not in path.read_bytes():
        raise BadUsage(f"'{path}' is cut short: the end marker of PNG is missing")
    image = np.ascontiguousarray(pixels[..., bands])
    budget = Budget(_format_terms(path, image, numbers, kind))
    return ForeignImage(image, budget, tuple(_notes(spec, bands, numbers, kind, image)))


def _pixels(source: Any, numbers: list[str]) -> Any:
    """All channels as float32 or float64, None on failure. Integers are divided here: OpenImageIO would lose a unit in the
    last place.
    """
    if len(set(numbers)) == 1 and numbers[0] in INTEGERS:
        number, largest = INTEGERS[numbers[0]]
        raw = source.read_image(number)
        return None if raw is None else raw.astype(np.float64) / largest
    return source.read_image(oiio.FLOAT if set(numbers) <= {"half", "float"} else oiio.DOUBLE)


def _refuse_what_is_no_film(path: Path, spec: Any) -> None:
    if spec.deep:
        raise BadUsage(f"'{path}' holds deep data, allowed one value per pixel and band")
    if spec.depth > 1:
        raise BadUsage(f"'{path}' holds a volume {spec.depth} deep, allowed a flat image")
    data = (spec.x, spec.y, spec.width, spec.height)
    display = (spec.full_x, spec.full_y, spec.full_width, spec.full_height)
    if data != display:
        raise BadUsage(f"'{path}': data window {_window(data)}, allowed the display window, {_window(display)}")
    orientation = spec.get_int_attribute("Orientation", 1)
    if orientation != 1:
        raise BadUsage(f"'{path}': orientation {orientation}, allowed 1 (row 0 on top, left to right)")


def _window(window: tuple[int, int, int, int]) -> str:
    x, y, width, height = window
    return f"{width}×{height} at ({x}, {y})"


def _bands(path: Path, spec: Any) -> list[int]:
    names = [str(name) for name in spec.channelnames]
    if len(names) < 3:
        raise BadUsage(f"'{path}' has the channels {', '.join(names)}, allowed R, G, B or three at least")
    return [names.index(band) for band in "RGB"] if {"R", "G", "B"} <= set(names) else [0, 1, 2]


def _format_terms(path: Path, image: Image, numbers: list[str], kind: str) -> tuple[Bound, ...]:
    """What storing the bands in this file has cost; storing in float32 is always counted by `uncertainty.stated`."""
    unknown = sorted(set(numbers) - set(INTEGERS) - set(FLOATS))
    if unknown:
        raise BadUsage(f"'{path}' holds {', '.join(unknown)}, allowed {', '.join((*FLOATS, *INTEGERS))}")
    terms = []
    if kind == "hdr":
        reach = np.repeat(np.abs(image.astype(np.float64)).max(axis=2, keepdims=True), 3, axis=2) * 2.0**-7
        reason = "one step of the 8-bit mantissa that three bands share: at most 2^-7 of the largest"
        terms.append(Bound("shared exponent", reason, abs=np.where(np.isfinite(reach), reach, 0.0)))
    elif "half" in numbers:
        terms.append(_half(image.astype(np.float64)))
    half_step = max((0.5 / INTEGERS[number][1] for number in numbers if number in INTEGERS), default=0.0)
    if half_step:
        # A writer that scales by N, adds ½ and truncates in float32 rounds twice, 2^-24 of L N + ½ each time.
        reason = f"half a step of {', '.join(sorted(set(numbers)))}, and float32 arithmetic in the writer"
        terms.append(Bound("quantisation", reason, abs=half_step * (1 + 2.0**-22), rel=2.0**-22))
    return tuple(terms)


def _half(image: npt.NDArray[np.float64]) -> Bound:
    """2^-11 |L|, 2^-25 below the smallest normal half number."""
    bound = np.maximum(2.0**-11 * np.abs(image), 2.0**-25)
    reason = "half a unit in the last place of a half float: 2^-11 |L|, at least 2^-25"
    return Bound("half", reason, abs=np.where(np.isfinite(bound), bound, 0.0))


def _notes(spec: Any, bands: list[int], numbers: list[str], kind: str, image: Image) -> Iterator[str]:
    names = [str(name) for name in spec.channelnames]
    aside = [name for index, name in enumerate(names) if index not in bands]
    if not {"R", "G", "B"} <= set(names):
        yield f"the channels {', '.join(names[band] for band in bands)} are taken as R, G, B"
    if aside:
        yield f"left aside: {', '.join(aside)}"
    if spec.get_int_attribute("oiio:subimages", 1) > 1:
        yield f"only the first of {spec.get_int_attribute('oiio:subimages', 1)} images in the file is judged"
    if set(numbers) & set(INTEGERS):
        yield "integers are taken as linear radiance, the largest as 1 W/(m²·sr); no transfer curve is undone"
        clipped = int((image >= 1).any(axis=2).sum())
        if clipped:
            yield f"{clipped} pixels hold the largest integer and may be clipped"
    compression = spec.get_string_attribute("compression").split(":")[0]
    if kind in LOSSY_FORMATS or compression not in EXACT_COMPRESSIONS:
        yield f"the compression '{compression or kind}' loses precision that no bound is stated for"


def _one_line(text: str) -> str:
    return " ".join(text.split())
