"""Cover goals on a run: what some run should show (SEMANTICS 4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rvmon.spec.checked.formula import Bound, BoundAtom
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


def goals_as_requirements(spec: CheckedSpec) -> CheckedSpec:
    """A specification whose requirements are the cover goals of another, for samples in order."""
    requirements = {
        name: Requirement(name, Mode.UPON, BoundAtom(Bound.START), cover.formula, span=cover.span)
        for name, cover in spec.covers.items()
    }
    return replace(spec, requirements=requirements, properties={}, covers={}, max_delay=None)


def goal_verdicts(report: Report) -> Mapping[str, Verdict]:
    """What a run says of each goal: `P` shown, `I` still possible at its end, else `NT`.

    No single run fails a goal.
    """
    verdicts = dict.fromkeys(report.verdicts, Verdict.NOT_TRIGGERED)
    for attempt in report.attempts:
        if attempt.verdict is Verdict.PASS:
            verdicts[attempt.requirement] = Verdict.PASS
        elif attempt.verdict is Verdict.INCONCLUSIVE and attempt.forecast is not Verdict.FAIL:
            verdicts[attempt.requirement] = Verdict.INCONCLUSIVE
    return verdicts
