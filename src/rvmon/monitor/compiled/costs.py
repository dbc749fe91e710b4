"""What judging a requirement costs, as far as its compiled form shows."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import PASSED
from rvmon.core.judges import machine_of
from rvmon.formula.horizon import horizon
from rvmon.monitor.compiled.code_plan import planned_rule
from rvmon.monitor.compiled.requirement import CompiledRequirement

_STEPS_EACH = "its automaton steps each open attempt"
"""Why windows judge what has an automaton."""

_RUN_BYTES = 20
"""Of an attempt in a run: the instant of its trigger, its number, what was seen."""


@dataclass(frozen=True, slots=True)
class CompileReport:
    """What became of a requirement.

    Attributes:
        judge: `automaton`; `windows` or `network` where that does not close, or would be slower.
        why: why no automaton judges it; empty if one does.
        letters: what its propositions can be, as its formula distinguishes them.
        horizon: ticks from the trigger within which an attempt is decided; `None` if unbounded.
        locations: of the automaton, both verdicts included; 0 if none judges. So are the others.
        clocks: the largest number that an attempt has.
        classes: of letters that lead the same way everywhere.
        in_runs: whether attempts are kept in runs, so that a sample costs the same however many of
            them are open.
        bytes_per_attempt: of memory, while it is open; `None` if it is an object of its own.
        steps: looked at when something changes or a time is due: of all runs, or of each attempt.
    """

    judge: str
    why: str
    letters: int
    horizon: int | None
    locations: int = 0
    clocks: int = 0
    classes: int = 0
    in_runs: bool = False
    bytes_per_attempt: int | None = None
    steps: int = 0


def compile_report(one: CompiledRequirement) -> CompileReport:
    """How a requirement is judged, and at what cost."""
    reach, letters = horizon(one.obligation.owed), one.alphabet.size
    automaton = one.automaton
    judge = machine_of(planned_rule(one), one.gap)
    if automaton is None or not isinstance(judge, Automaton):
        kind = "network" if isinstance(judge, Automaton) or judge[1] is None else "windows"
        return CompileReport(kind, one.refusal or _STEPS_EACH, letters, reach)
    in_runs = one.in_runs(automaton)
    live = automaton.locations[PASSED + 1 :]
    parts = sum(len(place.cuts[0]) + 1 if place.cuts else 1 for place in live)
    return CompileReport(
        "automaton",
        "",
        letters,
        reach,
        len(automaton.locations),
        automaton.clocks,
        automaton.classes,
        in_runs,
        _RUN_BYTES if in_runs else None,
        parts - 1 if in_runs else 1,
    )
