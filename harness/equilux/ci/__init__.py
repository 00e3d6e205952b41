"""What a CI reads of a run: JUnit XML, a Markdown job summary, annotations at the spec's lines.

All is made from results and the results tree; nothing is rendered or compared here.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from equilux.ci.view import RunView, sources_of

JUNIT_FILE, SUMMARY_FILE = "junit.xml", "summary.md"

__all__ = ["JUNIT_FILE", "SUMMARY_FILE", "RunView", "announce", "announces", "sources_of", "write_files"]


def write_files(view: RunView) -> None:
    """Write junit.xml and summary.md into the results tree, each whole or not at all. Raises OSError."""
    from equilux.ci.junit import junit
    from equilux.ci.summary import summary
    from equilux.wholefile import whole_file

    for name, content in ((JUNIT_FILE, junit(view)), (SUMMARY_FILE, summary(view).encode())):
        with whole_file(view.tree / name) as temporary:
            temporary.write_bytes(content)


def announces(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether `announce` would tell anybody anything."""
    return environment.get("GITHUB_ACTIONS") == "true" or bool(environment.get("GITHUB_STEP_SUMMARY"))


def announce(view: RunView, environment: Mapping[str, str] = os.environ, stream: TextIO | None = None) -> None:
    """Tell GitHub: annotations where it runs this, the summary where it asks for one. Does nothing elsewhere.

    Annotations go to stderr: stdout may be somebody's JSON. A summary that cannot be written is said and does not change the run.
    """
    stream = sys.stderr if stream is None else stream
    if environment.get("GITHUB_ACTIONS") == "true":
        from equilux.ci.annotations import commands

        stream.write("".join(f"{line}\n" for line in commands(view, environment.get("GITHUB_WORKSPACE"))))
        stream.flush()
    if target := environment.get("GITHUB_STEP_SUMMARY"):
        from equilux.ci.summary import job_summary

        try:
            with Path(target).open("a", encoding="utf-8") as file:
                file.write(job_summary(view))
        except OSError as problem:
            stream.write(f"the job summary cannot be written: {problem}\n")
