"""Green never hides a failure: the law on what was lost (SEMANTICS 7), to be tried on any judge."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from rvmon.language.checked.formula import Compare, Probe, ProbeAtom, UpdateValue
from rvmon.language.checked.specification import CheckedSpec
from rvmon.testing.generate import Rng
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.syntax import parts_of, subformulas
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report
from tests.tools.law import judge as oracle
from tests.tools.law import names_read
from tests.tools.refill import refilled


def is_spoken_of(spec: CheckedSpec) -> bool:
    """Whether the law speaks of a specification: not if it asks what is known.

    Nor if it counts updates of a signal that becomes stale: updates are what was lost then.
    """
    stale = {name for name, signal in spec.signals.items() if signal.stale_after is not None}
    for requirement in spec.requirements.values():
        expressions = [capture.value for capture in requirement.captures]
        for formula in (requirement.trigger, requirement.consequent):
            for part in subformulas(formula):
                if isinstance(part, ProbeAtom):
                    if part.probe is Probe.KNOWN or part.name in stale:
                        return False
                elif isinstance(part, Compare):
                    expressions += [part.left, part.right]
        for expression in expressions:
            for value in parts_of(expression):
                if isinstance(value, UpdateValue) and value.name in stale:
                    return False
    return True


def narrowed(case: Case) -> Case:
    """The case without the names that no requirement reads: the same to judge, and sooner."""
    spec = case.spec
    read = {name for one in spec.requirements.values() for name in names_read(one)}
    actions = tuple(
        replace(action, values={n: v for n, v in action.values.items() if n in read})
        if isinstance(action, Sample)
        else action
        for action in case.actions
    )
    signals = {name: signal for name, signal in spec.signals.items() if name in read}
    events = {name: event for name, event in spec.events.items() if name in read}
    outages = tuple(replace(outage, names=outage.names & read) for outage in case.outages)
    return replace(
        case,
        spec=replace(spec, signals=signals, events=events),
        actions=actions,
        outages=outages,
    )


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of filling in what a case lost.

    Attributes:
        verdicts: on the case itself.
        overturning: a filling that overturns one of them, if any was found.
        is_split: whether fillings with and without a failure were found; then only `I` is right.
    """

    verdicts: Mapping[str, Verdict]
    overturning: Case | None
    is_split: bool


def overturned(
    rng: Rng,
    case: Case,
    fillings: int,
    judge: Callable[[Case], Report] = oracle,
    *,
    whole: bool = True,
) -> Tried:
    """The verdicts on a case, against those with what it lost filled in at random.

    Source: SEMANTICS, section 7.
    """
    before = judge(case).verdicts
    seen: dict[str, set[bool]] = {name: set() for name in before}
    for _ in range(fillings):
        filled = refilled(rng, case, whole=whole)
        after = judge(filled).verdicts
        for name, verdict in before.items():
            green = verdict in (Verdict.PASS, Verdict.NOT_TRIGGERED)
            failed = after[name] is Verdict.FAIL
            seen[name].add(failed)
            if (green and failed) or (verdict is Verdict.FAIL and not failed):
                return Tried(before, filled, len(seen[name]) > 1)
    return Tried(before, None, any(len(kinds) > 1 for kinds in seen.values()))
