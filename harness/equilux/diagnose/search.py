"""The search for the smallest set of causes: first what is declared, then single causes, pairs, triples; each proven in full."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from equilux.compare import PairResult, RenderedImage
from equilux.diagnose import report
from equilux.diagnose.bounds import PairBounds, Tilts
from equilux.diagnose.catalogue import all_rules
from equilux.diagnose.diagnosis import Diagnosis
from equilux.diagnose.evidence import SLOW_S, gather
from equilux.diagnose.extension import extended
from equilux.diagnose.finding import MOST_CAUSES, Finding
from equilux.diagnose.fit import fitted, knobs_of, refine, rounded, started
from equilux.diagnose.hypotheses import Preference, Single, both_orders, every_hypothesis, is_costly, ranked_pairs, single
from equilux.diagnose.proof import Court, Proof, Restate
from equilux.diagnose.second_look import looked_at_again
from equilux.diagnose.trials import Bench, Causes, Trial, ordered
from equilux.diagnose.usual import all_usual
from equilux.edges import film_delta_px
from equilux_scenes.case import Case
from equilux_tracer import Tracer
from equilux_tracer.causes import Applied, Rule

PROOFS = 16
"""Hypotheses of one size that are proven in full, at most."""
PLAUSIBLE = 0.05
"""Share of the sampled pixels, wrong and right, that a hypothesis may miss and still be worth a proof."""
ALIKE = 1e-3
"""Causes that account for as many of the diverging pixels as others, but for this share, explain alike."""
EXCUSED, RESTATED = 0.3, 0.7
"""Share of the wrong ones that it may miss before edges are excused, and before geometric uncertainty is restated for it."""
CHEAP_PAIRS, USUAL_PAIRS, REFITTED = 400, 600, 12
"""Pairs that are tried as they stand; sets whose numbers are fitted to each other."""
SEEDS = 6
"""Sets to which one more cause is added: so many with the fewest pixels missed, so many nearest."""
CHEAP_UNTIL, COSTLY_BEFORE = 0.5, 0.5
"""Shares of the time after which no more pairs are tried as they stand, and no more meshes made: to find how many triangles one
has takes seconds."""
DECLARED_PROOFS = 4
"""Single causes that are proven beside a single declared one that explains alike."""
PROMISING = 0.98
"""A number is fitted beside other causes if a starting value brings the picture at least this much nearer."""
PARTIAL = 0.1
"""Least share of the diverging pixels that causes must bring within uncertainty to be named where they do not account for all:
a wrong cause with a fitted parameter hits some by chance."""


def diagnose(
    case: Case,
    side: RenderedImage,
    truth: RenderedImage,
    scored: PairResult,
    *,
    restate: Restate | None,
    dialect: Sequence[Applied] = (),
    expected: Sequence[str] = (),
    rules: Mapping[str, Rule] | None = None,
    time_limit_s: float = 20,
) -> Diagnosis:
    """Why `side` departs from `truth`.

    scored: their comparison (`compare_pair(side, truth, …)`). restate: the side's uncertainty with its geometric terms
    propagated through a changed tracer; None: as it is stated. dialect: what the adapter declares for this case. expected: ids
    of causes that the scene expects of it. time_limit_s: after so many seconds of work no new hypothesis is begun. Pixels that
    are not finite are no evidence; a picture of another size has no diagnosis.
    """
    started = time.monotonic()
    rules = all_rules() if rules is None else rules
    model = Tracer(case)
    sample = gather(case, side, truth, scored, model) if scored.planes else None
    if sample is None:
        return Diagnosis(adapter=side.adapter, diverging=0, explained=0.0, seconds=time.monotonic() - started)
    bounds = PairBounds.of(side, truth)
    bench = Bench(case=case, rules=rules, model=model, sample=sample, bounds=bounds, time_limit_s=time_limit_s)
    bench.tilts = Tilts.of(side.uncertainty, len(case.scene.objects)) if restate is not None else None
    bench.film_delta_px = film_delta_px(side.uncertainty.film_px, truth.uncertainty.film_px)
    preference = Preference(rules, tuple(dialect), tuple(expected))
    search = Search(bench, Court(bench, side, truth, scored, restate), preference)
    found = search.run()
    seconds = round(time.monotonic() - started, 3)
    return report.reported(search, found, side).model_copy(update={"tried": bench.tried, "seconds": seconds})


@dataclass(eq=False)
class Search:
    """One diagnosis under way."""

    bench: Bench
    court: Court
    preference: Preference
    singles: list[Single] = field(default_factory=list)
    numeric: list[Applied] = field(default_factory=list)
    """Hypotheses whose parameter is to be found: beside other causes it may be another one than alone."""
    tried: dict[Causes, Trial] = field(default_factory=dict)
    """The sets that stand for partial explanations."""
    dialect_agrees: bool | None = None

    def run(self) -> Finding | None:
        """The finding, or None where no cause accounts for a fair share of the pixels."""
        model = self.bench.trial(())
        assert model is not None  # the scene was rendered before
        if self.preference.dialect:
            declared = self._declared()
            if declared is not None:
                return declared
        hypotheses = every_hypothesis(self.bench, self.preference)
        late = [one for one in hypotheses if is_costly(self.bench, one) and self.preference.is_unheard_of(one)]
        found = self._proven(self._try_singles([one for one in hypotheses if one not in late], model))
        if found is None:
            found = self._proven(self._try_singles(late, model))
        if found is None and not self.bench.out_of_time:
            found = self._proven(self._pairs(model))
        if found is None and not self.bench.out_of_time:
            found = self._proven(self._triples())
        found = found if found is not None else self._partial(model)
        return found if found is None else extended(self, found)

    # --- what is declared ---------------------------------------------------------------------------------------------

    def _declared(self) -> Finding | None:
        """All that the adapter declares, then without what is not needed."""
        causes: Causes = ()
        for applied in self.preference.dialect:
            causes = ordered((*causes, self._resolved(causes, applied)), self.bench.rules)
        proof = self.court.proof(causes)
        self.dialect_agrees = proof is not None and proof.holds
        if proof is None or not proof.holds:
            return None
        for applied in causes:
            if len(proof.causes) == 1:
                break
            fewer = self.court.proof(tuple(other for other in proof.causes if other != applied))
            if fewer is not None and fewer.holds and fewer.explained >= proof.explained:
                proof = fewer
        return self.finding(proof, self._beside_declared(proof))

    def _beside_declared(self, proof: Proof) -> list[Causes]:
        """Other single causes that explain as much as a declared one, of those that need no fit: cheap to find."""
        if len(proof.causes) > 1 or self.bench.sample.seconds_per_position >= SLOW_S:
            return []
        found: list[Causes] = []
        for hypothesis in every_hypothesis(self.bench, self.preference):
            is_open = hypothesis.parameter is None and self.bench.rules[hypothesis.cause].parameter is not None
            if is_open or hypothesis.cause == proof.causes[0].cause or len(found) == DECLARED_PROOFS or self.bench.out_of_time:
                continue
            trial = self.bench.trial((hypothesis,))
            other = self.court.proof(trial.causes) if trial is not None and self._few(trial) else None
            if other is not None and other.holds and other.explained >= proof.explained - ALIKE:
                found.append(other.causes)
        return found

    def _resolved(self, others: Causes, applied: Applied) -> Applied:
        """A declared cause whose parameter depends on the scene, with the value that fits best."""
        rule = self.bench.rules[applied.cause]
        if applied.parameter is not None or rule.parameter is None:
            return applied
        options = [option for option in rule.hypotheses(self.bench.case) if option.reading == applied.reading] or [applied]
        trials: list[tuple[Trial, Applied]] = []
        for option in options:
            causes = (*others, option)
            trial = fitted(self.bench, causes, len(others)) if option.parameter is None else self.bench.trial(causes)
            if trial is not None:
                trials.append((trial, trial.causes[len(others)]))
        return min(trials, key=lambda pair: pair[0].badness)[1] if trials else applied

    # --- singles, pairs, triples --------------------------------------------------------------------------------------

    def _try_singles(self, hypotheses: Sequence[Applied], model: Trial) -> list[Trial]:
        for hypothesis in hypotheses:
            if self.bench.out_of_time or (is_costly(self.bench, hypothesis) and self._late):
                break
            if hypothesis.parameter is None and self.bench.rules[hypothesis.cause].parameter is not None:
                self.numeric.append(hypothesis)
            found = single(self.bench, hypothesis, model)
            if found is not None:
                self.singles.append(found)
                self.tried[found.trial.causes] = found.trial
        return [one.trial for one in self.singles]

    def _try_usual(self, model: Trial) -> None:
        """Usual values of what has a number, beside the fitted ones."""
        known = {one.applied for one in self.singles}
        for applied in all_usual(self.bench):
            found = single(self.bench, applied, model) if applied not in known else None
            if found is not None:
                self.singles.append(found)

    def _pairs(self, model: Trial) -> list[Trial]:
        """Pairs as they stand; then numbers fitted beside the likeliest single causes."""
        self._try_usual(model)
        usual = [one.trial for one in self.singles if self.plausible(one.trial) and one.trial.causes not in self.tried]
        if usual:
            return usual
        found = self._tried_all(self._cheap(ranked_pairs(self.bench, self.singles, model)), share=CHEAP_UNTIL)
        if any(self.plausible(trial) for trial in found):
            return found
        seeds = [one.trial for one in self.singles]
        best = [*sorted(seeds, key=_by_badness)[:SEEDS], *sorted(seeds, key=_by_distance)[:SEEDS]]
        likely = list(dict.fromkeys(trial.causes for trial in [*best, *sorted(seeds, key=self._disorder)[:SEEDS]]))
        found += self._with_numbers(likely)
        return found if any(self.plausible(trial) for trial in found) else [*found, *self._refitted_all(found)]

    def _cheap(self, ranked: Sequence[Causes]) -> list[Causes]:
        """The likeliest; and a usual value with any plain cause without a number, since of two highlights wrong together neither
        need look likely by itself."""
        known = set(all_usual(self.bench))
        plain = {one.applied for one in self.singles if not one.applied.reading and one.applied.parameter is None}
        usual = [
            causes for causes in ranked[CHEAP_PAIRS:] if not known.isdisjoint(causes) and all(a in plain | known for a in causes)
        ]
        return [*ranked[:CHEAP_PAIRS], *usual[:USUAL_PAIRS]]

    def _triples(self) -> list[Trial]:
        """The best pairs, each with every further cause, then with numbers fitted beside them."""
        pairs = [trial for trial in self.tried.values() if len(trial.causes) == 2]
        best = [*sorted(pairs, key=_by_badness)[:SEEDS], *sorted(pairs, key=_by_distance)[:SEEDS]]
        seeds = list(dict.fromkeys(trial.causes for trial in best))
        found: list[Trial] = []
        for seed in seeds:
            more = [one.applied for one in self.singles if one.applied.cause not in _ids(seed)]
            found += self._tried_all(ordered((*seed, applied), self.bench.rules) for applied in more)
        if any(self.plausible(trial) for trial in found):
            return found
        found += self._with_numbers(seeds)
        return found if any(self.plausible(trial) for trial in found) else [*found, *self._refitted_all(found)]

    def _with_numbers(self, seeds: Sequence[Causes]) -> list[Trial]:
        """Each seed with each cause that has a number, fitted beside it where its starting values promise anything."""
        found: list[Trial] = []
        costly = [hypothesis for hypothesis in self.numeric if is_costly(self.bench, hypothesis)]
        cheap = [hypothesis for hypothesis in self.numeric if hypothesis not in costly]
        for seed, hypotheses in [*((seed, cheap) for seed in seeds), *((seed, costly) for seed in seeds[: SEEDS // 2])]:
            alone = self.bench.trial(seed)
            for hypothesis in hypotheses:
                if self.bench.out_of_time or (hypotheses is costly and self._late):
                    return found
                if alone is None or hypothesis.cause in _ids(seed):
                    continue
                for causes in self._placed(seed, hypothesis):
                    place = causes.index(hypothesis)
                    starts = started(self.bench, causes, place)
                    if not starts or starts[0].distance > PROMISING * alone.distance:
                        continue
                    trial = fitted(self.bench, causes, place, starts)
                    if trial is not None:
                        trial = self.refitted_together(trial)
                        found.append(trial)
                        self.tried[trial.causes] = trial
                        if self.plausible(trial):
                            return found
        return found

    @property
    def _late(self) -> bool:
        return self.bench.time_left_s < (1 - COSTLY_BEFORE) * self.bench.time_limit_s

    def _placed(self, seed: Causes, hypothesis: Applied) -> list[Causes]:
        """The seed with one more cause: as a picture is made; of two also the other way round where that matters."""
        return (
            both_orders(self.bench, seed[0], hypothesis) if len(seed) == 1 else [ordered((*seed, hypothesis), self.bench.rules)]
        )

    def _refitted_all(self, trials: Sequence[Trial]) -> list[Trial]:
        """The nearest of those with numbers, fitted to each other until one is plausible."""
        nearest = [trial for trial in sorted(trials, key=_by_distance) if knobs_of(trial.causes, self.bench)]
        found = []
        for trial in nearest[:REFITTED]:
            if self.bench.out_of_time:
                break
            better = self.refitted(trial.causes)
            if better is not None:
                found.append(better)
                self.tried[better.causes] = better
                if self.plausible(better):
                    break
        return found

    def _disorder(self, trial: Trial) -> tuple[float, float]:
        """Least where the hypothesis puts the brightnesses into the order in which they were measured: a factor or a curve that
        is wrong as well does not hide that.
        """
        evidence = self.bench.sample.evidence
        ranks = [np.argsort(np.argsort(picture.sum(axis=1), kind="stable")) for picture in (evidence.measured, trial.radiance)]
        agreement = float(np.corrcoef(ranks[0], ranks[1])[0, 1]) if len(evidence.measured) > 2 else 0.0
        return -round(agreement, 3), trial.distance

    def _tried_all(self, sets: Iterable[Causes], *, share: float = 1.0) -> list[Trial]:
        """share: of the time that all may take, after which no more is tried."""
        out: list[Trial] = []
        for causes in sets:
            if self.bench.out_of_time or self.bench.time_left_s < (1 - share) * self.bench.time_limit_s:
                break
            trial = self.bench.trial(causes)
            if trial is not None:
                out.append(trial)
                self.tried[causes] = trial
        return out

    def refitted(self, causes: Causes) -> Trial | None:
        """The numbers of all causes fitted with the others as they are, one after another, and then together."""
        best = self.bench.trial(causes)
        if best is None:
            return None
        for index in range(len(causes)):
            if knobs_of((best.causes[index],), self.bench):
                found = fitted(self.bench, best.causes, index)
                best = min((best, found), key=_by_distance) if found is not None else best
        return self.refitted_together(best)

    def refitted_together(self, trial: Trial) -> Trial:
        """All numbers refined at once, from where they are."""
        knobs = knobs_of(trial.causes, self.bench)
        return rounded(self.bench, refine(self.bench, trial, knobs), knobs) if len({knob.cause for knob in knobs}) > 1 else trial

    def plausible(self, trial: Trial) -> bool:
        """Whether the sample speaks for it strongly enough for a proof."""
        diverging = int(self.bench.sample.diverging.sum())
        if self._few(trial):
            return True
        known = trial.missed <= (RESTATED if self.bench.tilts is not None else EXCUSED) * diverging
        return known and self._few(self.bench.exact(trial))

    def _few(self, trial: Trial) -> bool:
        diverging = int(self.bench.sample.diverging.sum())
        agreeing = len(self.bench.sample.pixels) - diverging
        return trial.missed <= max(1, PLAUSIBLE * diverging) and trial.broken <= max(1, PLAUSIBLE * agreeing)

    # --- proof --------------------------------------------------------------------------------------------------------

    def _proven(self, trials: Iterable[Trial]) -> Finding | None:
        """The best of those that hold; the others that hold as well are its alternatives."""
        worth = [trial for trial in trials if self.plausible(trial)]
        least = min((trial.distance for trial in worth), default=0.0)
        worth.sort(key=lambda trial: self._order(trial, least))
        if self.bench.tilts is not None:
            worth = [rounded(self.bench, trial, knobs_of(trial.causes, self.bench), exactly=True) for trial in worth[:PROOFS]]
        held = self._proofs(trial.causes for trial in worth[:PROOFS])
        proofs = [proof for proof in held if proof.holds] or looked_at_again(self.bench, self.court, held)
        if not proofs:
            return None
        nearest = max(proofs, key=lambda proof: proof.explained)
        proofs += [proof for proof in self._proofs(self._substitutes(nearest.causes)) if proof.holds and proof not in proofs]
        most = max(proof.explained for proof in proofs)
        alike = [proof for proof in proofs if proof.explained >= most - ALIKE]
        on_sample = {proof.causes: self.bench.trial(proof.causes) for proof in alike}
        least = min(trial.distance for trial in on_sample.values() if trial is not None)
        best = min(alike, key=lambda proof: self._order(on_sample[proof.causes], least))
        fewer = self._without_the_needless(best)
        others = [] if fewer is not best else [proof.causes for proof in alike if proof is not best]
        return self.finding(fewer, others)

    def _proofs(self, sets: Iterable[Causes]) -> list[Proof]:
        """One at least, and then as many as there is time for."""
        found: list[Proof] = []
        for causes in sets:
            if found and self.bench.out_of_time:
                break
            proof = self.court.proof(causes)
            if proof is not None:
                found.append(proof)
        return found

    def _without_the_needless(self, proof: Proof) -> Proof:
        """The smallest of the sets that leave no more over."""
        for applied in sorted(proof.causes, key=self.preference.of, reverse=True):
            rest = tuple(other for other in proof.causes if other != applied)
            fewer = self.court.proof(rest) if rest else None
            if fewer is not None and int(fewer.left.sum()) <= int(proof.left.sum()):
                return self._without_the_needless(fewer)
        return proof

    def _substitutes(self, causes: Causes) -> list[Causes]:
        """Sets that have another cause in one place and do as well on the sample; of single causes all were tried before."""
        found: list[Causes] = []
        for place in range(len(causes) if len(causes) > 1 else 0):
            for one in self.singles:
                changed = (*causes[:place], one.applied, *causes[place + 1 :])
                if self.bench.out_of_time or len(found) >= PROOFS:
                    return found
                trial = self.bench.trial(changed) if one.applied.cause not in _ids(causes) else None
                if trial is not None and self._few(trial):
                    found.append(changed)
        return found

    def _order(self, trial: Trial | None, least: float = 0.0) -> tuple[object, ...]:
        """Preferred names first; of those neither declared nor expected, the clearly nearer ones. least: the distance of the
        nearest of those that are compared."""
        assert trial is not None
        declared, expected, numbers, each = self.preference.of_all(trial.causes)
        nearness = int(trial.distance > 1.25 * least + 0.05 * len(trial.error))
        return (declared, expected, nearness, numbers, each)

    def finding(self, proof: Proof, others: Sequence[Causes]) -> Finding:
        without: list[Proof | None] = []
        for applied in proof.causes:
            rest = tuple(other for other in proof.causes if other != applied)
            without.append(self.court.proof(rest) if rest else None)
        return Finding(proof, tuple(without), tuple(others))

    def _partial(self, model: Trial) -> Finding | None:
        """The set that brings most pixels within uncertainty, every cause of it some of its own."""
        diverging = int(self.bench.sample.diverging.sum())
        best, least = None, model.missed * (1 - PARTIAL)
        for size in range(1, MOST_CAUSES + 1):
            of_size = [trial for trial in self.tried.values() if len(trial.causes) == size]
            of_size.sort(key=lambda trial: (trial.missed + trial.broken, self._order(trial)))
            for trial in of_size[:2]:
                if trial.missed + trial.broken > least:
                    break
                proof = self.court.proof(trial.causes)
                if proof is not None and proof.harmless and self._says_much(proof):
                    best, least = proof, trial.missed + trial.broken - PARTIAL / 2 * diverging
                    break
        return None if best is None else self.finding(self._without_the_needless(best), [])

    def _says_much(self, proof: Proof) -> bool:
        """Whether many *different* values are accounted for: black is hit by every rule that makes things black."""
        values = np.unique(self.court.side.image[proof.mended], axis=0)
        return len(values) >= PARTIAL * proof.diverging


def _ids(causes: Causes) -> set[str]:
    return {applied.cause for applied in causes}


def _by_distance(trial: Trial) -> float:
    return trial.distance


def _by_badness(trial: Trial) -> tuple[int, float]:
    return trial.badness


__all__ = ["Finding", "Search", "diagnose"]
