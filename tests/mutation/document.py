"""docs/mutation.md: the figures of the suite against what is demanded, the confusion matrix, and what other tools let through."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from equilux_scenes.causes import CAUSES
from mutation.rivals import NAMES
from mutation.trial import ALMOST_ALL, BUDGET, SCENES_PER_MUTANT, Trial

if TYPE_CHECKING:
    from mutation.suite import Results

SINGLE_DEMAND, PAIR_DEMAND, UNMUTATED_DEMAND = 0.95, 0.80, 200


@dataclass(frozen=True)
class Figures:
    """Trials of single or of paired faults."""

    trials: list[Trial]

    @property
    def mutants(self) -> int:
        return len({trial.mutant for trial in self.trials})

    @property
    def detected(self) -> int:
        return sum(trial.detected for trial in self.trials)

    @property
    def named(self) -> int:
        return sum(trial.named for trial in self.trials)

    @property
    def told_apart(self) -> int:
        """Named by their own ids, not as what the scene cannot tell from them."""
        return sum(trial.named and Counter(trial.causes) == Counter(c["id"] for c in trial.found) for trial in self.trials)


def singles(results: Results) -> Figures:
    return Figures([trial for trial in results.trials if len(trial.causes) == 1])


def pairs(results: Results) -> Figures:
    return Figures([trial for trial in results.trials if len(trial.causes) > 1])


def unmet(results: Results) -> list[str]:
    """Each demand that is not met, in words. What was not tried is not judged."""
    problems = []
    for what, some, demand in (("single", singles(results), SINGLE_DEMAND), ("paired", pairs(results), PAIR_DEMAND)):
        if some.detected < len(some.trials):
            problems.append(f"{what} faults: {some.detected} of {len(some.trials)} visible ones detected, demanded all")
        if some.named < demand * len(some.trials):
            problems.append(f"{what} faults: {_share(some.named, len(some.trials))} named right, demanded {demand:.0%}")
        short = [name for name, count in Counter(t.mutant for t in some.trials).items() if count < SCENES_PER_MUTANT]
        problems += [f"{name}: visible on fewer than {SCENES_PER_MUTANT} scenes" for name in short]
    if results.false_alarms:
        problems.append(f"false alarms: {', '.join(results.false_alarms)}")
    if 0 < results.unmutated < UNMUTATED_DEMAND:
        problems.append(f"only {results.unmutated} unmutated cases, demanded {UNMUTATED_DEMAND}")
    if results.passed:
        problems.append(f"broken pictures let through: {'; '.join(results.passed)}")
    return problems


def summary(results: Results) -> str:
    lines = [f"{what}: {value}" for what, value, _ in _figures(results)]
    lines += ["", *(f"NOT MET: {problem}" for problem in unmet(results))] if unmet(results) else ["every demand is met"]
    return "\n".join(lines)


def page(results: Results) -> str:
    parts = [_INTRODUCTION, _demands(results), _matrix(results), _misnamed(results), _others(results)]
    return "\n\n".join(parts) + "\n"


# --- sections ---------------------------------------------------------------------------------------------------------

_INTRODUCTION = f"""# How good the harness is at finding faults

Written by `make mutation`; do not edit.

A plain renderer of its own (`tests/mutation/`: NumPy, double precision, no code of the tracer, the oracle or the rules) is given
one fault, or two at once, and its pictures are judged and diagnosed as any adapter's. It states an error of at most
{BUDGET.terms[0].abs:g} + {BUDGET.terms[0].rel:g} |L| and writes float32. Each mutant is tried on the first
{SCENES_PER_MUTANT} scenes on which it is *visible*: on some pixel that no discontinuity crosses, its picture moves by more
than the pair's B; of two faults, each must show beside the other. Scenes are corpus and made-up ones in turn, at most 64 × 48
pixels.

A fault counts as *named* where the diagnosis gives exactly the injected causes, and they account for {ALMOST_ALL:.0%} of the
diverging pixels at least; a cause may also be listed among those which the scene provably cannot tell from the one given."""


def _figures(results: Results) -> list[tuple[str, str, str]]:
    one, two = singles(results), pairs(results)
    rows = []
    for what, some, demand in (("single faults", one, "95 %"), ("pairs of faults", two, "80 %")):
        count = len(some.trials)
        rows += [
            (f"{what}: mutants, scenes", f"{some.mutants} mutants, {count} scenes", "≥ 30" if some is one else "≥ 20"),
            (f"{what}: detected where visible", _share(some.detected, count), "100 %"),
            (f"{what}: named right", _share(some.named, count), demand),
            (f"{what}: of these told from every other cause", _share(some.told_apart, some.named), ""),
        ]
    alarms = f"{len(results.false_alarms)} of {results.unmutated}"
    rows.append(("unmutated cases that diverge", alarms, f"0 of ≥ {UNMUTATED_DEMAND}"))
    rows.append(("broken pictures let through", f"{len(results.passed)} of {results.broken}", "0"))
    return rows


def _demands(results: Results) -> str:
    rows = [f"| {what} | {value} | {demand} |" for what, value, demand in _figures(results)]
    return "\n".join(["## Figures", "", "| | found | demanded |", "| --- | --- | --- |", *rows])


def _matrix(results: Results) -> str:
    """One row per injected id; beside it what it was named, most often first."""
    lines = [
        "## Confusion matrix: single faults",
        "",
        "Every row is an injected cause; what it was named stands beside it with the number of scenes. `a ≡ b`: named a, with b"
        " listed as what the scene cannot tell from it. Columns that would hold 0 are left out.",
        "",
        "| injected | mutants | scenes | detected | named right | named |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for cause in CAUSES:
        some = [trial for trial in singles(results).trials if trial.causes == (cause,)]
        if some:
            names = Counter(_label(trial) for trial in some)
            named = ", ".join(f"{name} {count}" for name, count in sorted(names.items(), key=lambda item: (-item[1], item[0])))
            figures = Figures(some)
            lines.append(
                f"| `{cause}` | {figures.mutants} | {len(some)} | {figures.detected} | {figures.named} | {named or '–'} |"
            )
    lines += [
        "",
        "## Pairs",
        "",
        "| injected | scenes | detected | named right | named otherwise |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name in dict.fromkeys(trial.mutant for trial in pairs(results).trials):
        figures = Figures([trial for trial in pairs(results).trials if trial.mutant == name])
        otherwise = Counter(_label(trial) for trial in figures.trials if not trial.named)
        wrong = ", ".join(f"{label} {count}" for label, count in sorted(otherwise.items(), key=lambda item: (-item[1], item[0])))
        lines.append(f"| {name} | {len(figures.trials)} | {figures.detected} | {figures.named} | {wrong or '–'} |")
    return "\n".join(lines)


def _label(trial: Trial) -> str:
    """What a trial was named."""
    if not trial.detected:
        return "not detected"
    if not trial.found:
        return "nothing"
    parts = []
    for cause in trial.found:
        through = [injected for injected in trial.causes if injected in cause["alternatives"] and injected != cause["id"]]
        same = f" ≡ {', '.join(f'`{other}`' for other in through)}" if through and trial.named else ""
        parts.append(f"`{cause['id']}`{same}")
    return " + ".join(parts)


def _misnamed(results: Results) -> str:
    lines = ["## Misnamed", ""]
    wrong = [trial for trial in results.trials if not trial.named]
    for trial in wrong:
        given = "; ".join(_cause(cause) for cause in trial.found) or "nothing"
        lines.append(f"- {trial.mutant}, on {trial.case} ({trial.visible} pixels): {given}")
    return "\n".join(lines if wrong else [*lines, "None."])


def _cause(cause: dict[str, object]) -> str:
    parameter = cause["parameter"]
    shown = "" if parameter is None else f" [{parameter:.6g}]" if isinstance(parameter, float) else f" [{parameter}]"
    return f"`{cause['id']}`{shown}"


def _others(results: Results) -> str:
    lines = [
        "## Beside other tools",
        "",
        "The same visible mutants against the truth, at the thresholds that are customary: `idiff` of OpenImageIO with its"
        " defaults (any band off by 1e-6 fails), with `-fail 0.004 -failpercent 0.2`, the mean of HDR-FLIP, and SSIM"
        " (11 × 11 Gaussian window, the truth's range). None of them says why.",
        "",
        "| tool | single faults let through | pairs let through | unmutated cases refused |",
        "| --- | --- | --- | --- |",
    ]
    one, two = singles(results).trials, pairs(results).trials
    ours = [sum(not trial.detected for trial in some) for some in (one, two)]
    alarms = f"{len(results.false_alarms)} of {results.unmutated}"
    lines.append(f"| equilux | {_share(ours[0], len(one))} | {_share(ours[1], len(two))} | {alarms} |")
    for tool in NAMES:
        through = [_share(sum(trial.rivals.get(tool, False) for trial in some), len(some)) for some in (one, two)]
        lines.append(f"| {tool} | {through[0]} | {through[1]} | {results.rival_alarms.get(tool, 0)} of {results.unmutated} |")
    return "\n".join(lines)


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole} ({100 * part / whole:.1f} %)" if whole else "none tried"
