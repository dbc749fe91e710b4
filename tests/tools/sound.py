"""Green never hides a failure: the law on what was lost (SEMANTICS 7), to be tried on any judge."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rvmon.spec.checked.formula import Compare, Probe, ProbeAtom, UpdateValue
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from rvmon.testing.generate.rng import Rng
from rvmon.testing.law.walk import parts_of, subformulas
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict
from tests.tools.law import judge as oracle
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


def overturned(
    rng: Rng, case: Case, fillings: int, judge: Callable[[Case], Report] = oracle
) -> tuple[Mapping[str, Verdict], Case | None]:
    """The verdicts on a case, and a filling of what it lost that overturns one, if any was found.

    Args:
        rng: draws what is filled in.
        case: of a specification that the law speaks of.
        fillings: so many are tried.
        judge: gives the verdicts.

    Source: SEMANTICS, section 7.
    """
    before = judge(case).verdicts
    for _ in range(fillings):
        filled = refilled(rng, case)
        after = judge(filled).verdicts
        for name, verdict in before.items():
            green = verdict in (Verdict.PASS, Verdict.NOT_TRIGGERED)
            failed = after[name] is Verdict.FAIL
            if (green and failed) or (verdict is Verdict.FAIL and not failed):
                return before, filled
    return before, None
