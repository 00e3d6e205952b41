"""Mean HDR-FLIP error of two renders: a perceptual aid beside the verdict, never a part of it.

flip-evaluator ends the whole process where it cannot choose its exposures (a black reference, radiances of 1e-30), so it runs
in one of its own: `python -m equilux.hdr_flip PAIR.npz`.
"""

from __future__ import annotations

import importlib.util
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

MARK = "mean HDR-FLIP:"
TIMEOUT_S = 600.0


def mean_flip(image: npt.NDArray[np.floating], reference: npt.NDArray[np.floating]) -> float | None:
    """Mean HDR-FLIP error (Andersson et al. 2021), in [0, 1]; None where a value is not finite or FLIP gives no number.

    image, reference: (h, w, 3) linear radiance; negative values count as 0, as FLIP demands. Raises ModuleNotFoundError,
    saying what to install, where flip-evaluator is missing.
    """
    if importlib.util.find_spec("flip_evaluator") is None:
        raise ModuleNotFoundError("HDR-FLIP needs the package flip-evaluator: install equilux[flip]")
    if not (np.isfinite(image).all() and np.isfinite(reference).all()):
        return None
    with tempfile.TemporaryDirectory(prefix="equilux-flip-") as folder:
        pair = Path(folder) / "pair.npz"
        np.savez(pair, image=image, reference=reference)
        try:
            command = [sys.executable, "-m", "equilux.hdr_flip", str(pair)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired:
            return None
    answers = [line.removeprefix(MARK) for line in done.stdout.splitlines() if line.startswith(MARK)]
    if done.returncode != 0 or len(answers) != 1:
        return None
    mean = float(answers[0])
    return mean if math.isfinite(mean) else None


def _main(pair: Path) -> None:
    import flip_evaluator

    with np.load(pair, allow_pickle=False) as arrays:
        largest = float(np.finfo(np.float32).max)
        image, reference = (np.clip(arrays[name], 0.0, largest).astype(np.float32) for name in ("image", "reference"))
    _, mean, _ = flip_evaluator.evaluate(reference, image, "HDR", applyMagma=False)
    print(f"{MARK}{float(mean)!r}")


if __name__ == "__main__":
    _main(Path(sys.argv[1]))
