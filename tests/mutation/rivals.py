"""What other comparing tools say of a mutant, at the thresholds that are customary for them."""

from __future__ import annotations

import multiprocessing
import shutil
import subprocess
import sys
import tempfile
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio

Image = npt.NDArray[np.float32]

FLIP_LIMIT = 0.05
"""Mean FLIP below which two pictures commonly count as alike."""
SSIM_LIMIT = 0.95
"""SSIM above which they do."""
IDIFF_TOLERANT = ("-fail", "0.004", "-failpercent", "0.2")
"""A customary leniency: one step of 8 bits, on all but two pixels in a thousand."""
NAMES = ("idiff", "idiff, one step of 8 bits", "FLIP mean < 0.05", "SSIM > 0.95")


def let_through(image: Image, truth: Image) -> dict[str, bool]:
    """Tool → whether it takes the picture for the truth. A picture of another size is refused by all."""
    if image.shape != truth.shape:
        return dict.fromkeys(NAMES, False)
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        files = [Path(folder) / name for name in ("image.exr", "truth.exr")]
        for file, pixels in zip(files, (image, truth), strict=True):
            _write(file, pixels)
        strict, tolerant = _idiff(*files), _idiff(*files, *IDIFF_TOLERANT)
    flip = _flip.mean(image, truth)
    answers = (strict, tolerant, flip is not None and flip < FLIP_LIMIT, ssim(image, truth) > SSIM_LIMIT)
    return dict(zip(NAMES, answers, strict=True))


def _write(path: Path, pixels: Image) -> None:
    height, width = pixels.shape[:2]
    out = oiio.ImageOutput.create(str(path))
    assert out is not None, oiio.geterror()
    assert out.open(str(path), oiio.ImageSpec(width, height, 3, oiio.FLOAT)), out.geterror()
    assert out.write_image(np.ascontiguousarray(pixels, np.float32)), out.geterror()
    out.close()


def _idiff(image: Path, truth: Path, *options: str) -> bool:
    program = Path(sys.executable).with_name("idiff")
    command = [str(program if program.exists() else shutil.which("idiff")), *options, str(image), str(truth)]
    return subprocess.run(command, capture_output=True, check=False).returncode in (0, 1)  # 1 is a warning


# --- SSIM -------------------------------------------------------------------------------------------------------------


def ssim(image: Image, truth: Image) -> float:
    """Mean structural similarity of all bands (Wang et al. 2004): Gaussian window of 11 × 11 with σ = 1.5, K₁ = 0.01, K₂ = 0.03,
    L the truth's range. NaN, so never above a limit, where a value is not finite.
    """
    a, b = image.astype(np.float64), truth.astype(np.float64)
    reach = float(np.ptp(b)) or 1.0
    c1, c2 = (0.01 * reach) ** 2, (0.03 * reach) ** 2
    mean_a, mean_b = _blurred(a), _blurred(b)
    var_a, var_b = _blurred(a * a) - mean_a**2, _blurred(b * b) - mean_b**2
    covariance = _blurred(a * b) - mean_a * mean_b
    with np.errstate(invalid="ignore"):
        similar = (2 * mean_a * mean_b + c1) * (2 * covariance + c2) / ((mean_a**2 + mean_b**2 + c1) * (var_a + var_b + c2))
    return float(similar.mean())


def _blurred(image: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x = np.arange(-5, 6)
    weights = np.exp(-(x**2) / (2 * 1.5**2))
    weights /= weights.sum()
    for axis in (0, 1):
        padding = [(5, 5) if k == axis else (0, 0) for k in range(3)]
        wide = np.pad(image, padding, mode="symmetric")
        image = np.sum([w * wide.take(np.arange(k, k + image.shape[axis]), axis) for k, w in enumerate(weights)], axis=0)
    return image


# --- FLIP -------------------------------------------------------------------------------------------------------------


class Flip:
    """FLIP in a process of its own, which is started again when it ends: a black reference ends it."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def mean(self, image: Image, truth: Image) -> float | None:
        """Mean HDR-FLIP; None where a value is not finite or FLIP gives no number."""
        if not (np.isfinite(image).all() and np.isfinite(truth).all()):
            return None
        if self._pipe is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
            self._process.start()
            theirs.close()
        try:
            self._pipe.send((np.maximum(image, 0), np.maximum(truth, 0)))
            answer = self._pipe.recv()
        except (EOFError, OSError):
            self._pipe = None
            return None
        return answer if np.isfinite(answer) else None


def _serve(pipe: Connection) -> None:
    import flip_evaluator

    while True:
        try:
            image, truth = pipe.recv()
        except EOFError:
            return
        _, mean, _ = flip_evaluator.evaluate(truth, image, "HDR", applyMagma=False)
        pipe.send(float(mean))


_flip = Flip()
