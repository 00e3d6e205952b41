"""A kernel has no code for what its scene does not need: seen in the disassembly of the built extension."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping

import pytest

from equilux_tracer import _tracer

OBJDUMP = shutil.which("objdump")
FUNCTION = re.compile(r"^[0-9a-f]+ <(.+)>:$")
CALL = re.compile(r"\t(?:call|jmp)q?\s+[0-9a-f]+ <([^>]+?)(?:\+0x[0-9a-f]+)?>$")
KERNEL = re.compile(r"packets3run\w*?CompiledILi(\d+)ELb([01])ELb([01])ELb([01])E")

pytestmark = pytest.mark.skipif(OBJDUMP is None, reason="objdump (binutils) is not installed")


def called_by(path: str) -> Mapping[str, set[str]]:
    """Function → the functions that it calls or jumps to, by their mangled names."""
    calls: dict[str, set[str]] = {}
    current: set[str] = set()
    command = [str(OBJDUMP), "-d", "--no-show-raw-insn", "--section=.text", path]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if start := FUNCTION.match(line):
                current = calls.setdefault(start[1], set())
            elif call := CALL.search(line.rstrip()):
                current.add(call[1])
    return calls


def reachable(calls: Mapping[str, set[str]], start: str) -> set[str]:
    found, open_ends = {start}, [start]
    while open_ends:
        for name in calls.get(open_ends.pop(), set()) - found:
            found.add(name)
            open_ends.append(name)
    return {name.partition("@")[0] for name in found}


@pytest.fixture(scope="module")
def kernels() -> Mapping[tuple[int, bool, bool, bool], set[str]]:
    """(lanes of a register, shadows, highlights, several lights) → what can be reached from that kernel."""
    calls = called_by(str(_tracer.__file__))

    def named() -> Iterator[tuple[tuple[int, bool, bool, bool], set[str]]]:
        for name in calls:
            if found := KERNEL.search(name):
                width, *flags = (int(number) for number in found.groups())
                yield (width, bool(flags[0]), bool(flags[1]), bool(flags[2])), reachable(calls, name)

    return dict(named())


def test_every_combination_of_features_has_a_kernel_of_its_own(kernels):
    widths = {key[0] for key in kernels}
    assert widths, "no kernel is named in the extension: was it stripped?"
    assert len(kernels) == 8 * len(widths), sorted(kernels)


def test_only_kernels_with_highlights_raise_to_a_power(kernels):
    for (width, shadows, highlights, several), names in kernels.items():
        assert ("exp" in names, "log1p" in names) == (highlights, highlights), (width, shadows, highlights, several)


def test_only_kernels_with_shadows_send_shadow_rays(kernels):
    for (width, shadows, highlights, several), names in kernels.items():
        sent = any(name.startswith("rtcOccluded") for name in names)
        assert sent == shadows, (width, shadows, highlights, several)
        assert any(name.startswith("rtcIntersect") for name in names), (width, shadows, highlights, several)
