"""Why two peers diverge: what was found of either against the truth, put together and kept for the next run."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from equilux.adapter import Case
from equilux.compare import PairResult
from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.diagnosing import Subject, known_rules, restating
from equilux.identity import case_digest, diagnoser_identity
from equilux.reuse import Store, key
from equilux.tree import Tree, read_json
from equilux.wholefile import write_json

EXPLANATION_FILE = "explanation.json"


@dataclass(frozen=True)
class Explanation:
    """The share of a pair's diverging pixels that the causes of both sides account for, and those causes."""

    explained: float
    causes: tuple[Found, ...]


class Peers:
    """Of one case: how far what was found of each render accounts for how they differ from one another.

    subjects: all renders that pairs are asked of, with their diagnoses (None where they agree with the truth). What a render
    shows under its causes is computed when the first pair asks that is not in the store.
    """

    def __init__(
        self, case: Case, subjects: Mapping[str, tuple[Subject, Diagnosis | None]], store: Store | None, tree: Tree
    ) -> None:
        self._case, self._subjects, self._store, self._tree = case, subjects, store, tree
        self._accounts: Any = None
        self._added: set[str] = set()

    def explained(self, pair: PairResult) -> Explanation | None:
        """None where nothing can be said: a picture of another size."""
        its_key = key(
            what="explanation",
            case=case_digest(self._case),
            sides=[self._part_of_key(name) for name in (pair.json["a"], pair.json["b"])],
            code=diagnoser_identity(known_rules()),
        )
        folder = self._tree.stage()
        try:
            if self._store is not None and self._store.fetch("explanations", its_key, folder):
                earlier = read_json(folder / EXPLANATION_FILE)
                if earlier is not None:
                    return Explanation(earlier["explained"], tuple(Found.model_validate(cause) for cause in earlier["causes"]))
            found = self._asked(pair)
            if found is not None and self._store is not None:
                written = {"explained": found.explained, "causes": [cause.model_dump(mode="json") for cause in found.causes]}
                self._store.put("explanations", its_key, lambda entry: write_json(entry / EXPLANATION_FILE, written))
            return found
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _part_of_key(self, name: str) -> Any:
        subject, diagnosis = self._subjects[name]
        causes = [] if diagnosis is None else [cause.model_dump(mode="json") for cause in diagnosis.causes]
        return [name, subject.digest, subject.truth.adapter, subject.truth_digest, causes]

    def _asked(self, pair: PairResult) -> Explanation | None:
        from equilux.diagnose.peers import Accounts

        names = (pair.json["a"], pair.json["b"])
        if self._accounts is None:
            self._accounts = Accounts(self._case, self._subjects[names[0]][0].truth, known_rules())
        for name in sorted(set(names) - self._added):
            subject, diagnosis = self._subjects[name]
            restate = restating(subject.side, subject.budget()) if diagnosis is not None else None
            self._accounts.add(subject.side, subject.scored(), diagnosis, restate=restate)
            self._added.add(name)
        found = self._accounts.explain(*names, pair.planes["class"])
        return None if found is None else Explanation(found.explained, tuple(found.causes))
