"""A specification analysed: findings, and the shortest timelines of its conflicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.analysis.findings import Examination, examine, findings_of
from rvmon.analysis.requirement import Conflict, Subject
from rvmon.diagnostics import Diagnostic
from rvmon.explain.example import Budget, Example
from rvmon.explain.search import Goal, shortest_examples
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.verdict.verdict import Verdict

CONFLICT_RUNS = 400
"""Short runs that are tried for the timeline of one conflict."""

_OPEN, _MET = "open", "met"


@dataclass(frozen=True, slots=True)
class Analysis:
    """What an analysis found.

    Attributes:
        findings: as diagnostics.
        examination: the same as data, with what was not decided.
        timelines: of the first conflicts, the shortest run that triggers them as given.
    """

    findings: tuple[Diagnostic, ...]
    examination: Examination
    timelines: tuple[tuple[Conflict, Example], ...]


def analyse(compiled: CompiledSpec, *, seconds: float = 8.0, timelines: int = 3) -> Analysis:
    """Analyse a specification.

    Args:
        compiled: the specification.
        seconds: the budget of the examination; what is not reached counts as not decided.
        timelines: of so many conflicts at most the timeline is looked for.
    """
    subjects = [
        Subject(one.requirement, one.obligation.trigger, one.automaton, one.reads)
        for one in compiled.requirements.values()
    ]
    found = examine(compiled.checked, subjects, seconds)
    drawn = []
    for conflict in found.conflicts[:timelines]:
        example = conflict_example(compiled, conflict)
        if example is not None:
            drawn.append((conflict, example))
    return Analysis(tuple(findings_of(compiled.checked, found)), found, tuple(drawn))


def conflict_example(compiled: CompiledSpec, conflict: Conflict) -> Example | None:
    """The shortest run found that triggers conflicting requirements as the conflict says.

    One on which none has failed yet is preferred.
    """
    chosen = [compiled.requirements[name] for name in dict.fromkeys(conflict.ids)]
    goal = _triggered_as(conflict.ids, conflict.offsets)
    step = min((offset for offset in conflict.offsets if offset), default=0)
    budget = Budget(runs=CONFLICT_RUNS, samples=3, step=step)
    found = shortest_examples(compiled, chosen, goal, [_OPEN, _MET], budget).examples
    return found.get(_OPEN) or found.get(_MET)


def _triggered_as(ids: Sequence[str], offsets: Sequence[int]) -> Goal:
    def goal(example: Example) -> str | None:
        triggers = {
            name: {a.triggered for a in example.attempts if a.requirement == name} for name in ids
        }
        for first in triggers[ids[0]]:
            pairs = zip(ids, offsets, strict=True)
            if all(first + offset in triggers[name] for name, offset in pairs):
                return _MET if Verdict.FAIL in example.verdicts.values() else _OPEN
        return None

    return goal
