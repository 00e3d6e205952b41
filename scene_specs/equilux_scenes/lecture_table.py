"""The table "what of the lecture is implemented, where, shown by which scene", made from the shipped corpus.

A row without a scene, or a scene without the features of its row, cannot pass, so that the table cannot lie.
`python -m equilux_scenes.lecture_table README.md` writes it between its two marks.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from equilux_scenes.lecture import ROWS, missing_features
from equilux_scenes.loader import SceneFile, corpus_folder, load_scenes

BEGIN, END = "<!-- lecture table: begin -->", "<!-- lecture table: end -->"


def scenes_by_row(files: Iterable[SceneFile]) -> Mapping[str, list[SceneFile]]:
    """Row id → the scenes that show it. Raises ValueError for a scene that lacks what its row needs; for a row without one."""
    found: dict[str, list[SceneFile]] = {row_id: [] for row_id in ROWS}
    for file in files:
        for row_id in file.scene.shows:
            features = {feature for case in file.cases for feature in case.requires}
            if lacking := missing_features(row_id, features):
                raise ValueError(f"{file.scene.name}: shows '{row_id}' but requires no {', '.join(lacking)}")
            found[row_id].append(file)
    if empty := [row_id for row_id, shown in found.items() if not shown]:
        raise ValueError(f"no scene of the corpus shows {', '.join(empty)}")
    return found


def table() -> str:
    """The lecture table as Markdown."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    root = corpus_folder()
    yield "| the lecture | implemented as | where | shown by |"
    yield "| --- | --- | --- | --- |"
    for row_id, files in scenes_by_row(load_scenes([root])).items():
        row = ROWS[row_id]
        where = ", ".join(f"[{Path(path).name}]({path})" for path in row.where)
        shown = ", ".join(
            f"[{file.scene.name}](scene_specs/equilux_scenes/corpus/{file.path.relative_to(root).as_posix()})"
            for file in files
            if file.path is not None
        )
        formula = row.formula.replace("|", "\\|")
        yield f"| {row.topic} | {formula} | {where} | {shown} |"


def inserted(text: str) -> str:
    """`text` with the table between its two marks replaced. Raises ValueError where the marks are missing."""
    begin, end = text.find(BEGIN), text.find(END)
    if begin < 0 or end < begin:
        raise ValueError(f"the marks {BEGIN} and {END} are not there in this order")
    return f"{text[: begin + len(BEGIN)]}\n{table()}{text[end:]}"


if __name__ == "__main__":
    readme = Path(sys.argv[1])
    readme.write_text(inserted(readme.read_text(encoding="utf-8")), encoding="utf-8")
