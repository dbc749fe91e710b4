"""What the law says of a case."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rvmon.language.checked.names_read import names_of_requirement
from rvmon.language.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.word import Word
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report


def judge(case: Case) -> Report:
    """The oracle's report on a case."""
    return evaluate(case.spec, case.samples, **_told(case))


def word(case: Case) -> Word:
    """The trace of a case, position by position."""
    return word_of(case.spec, case.samples, **_told(case))


def _told(case: Case) -> dict[str, Any]:
    return {
        "end": case.end,
        "advances": case.advances,
        "names": case.names,
        "outages": case.outages,
    }


def names_read(requirement: Requirement, *, keys: bool = True) -> frozenset[str]:
    """The signals and events that a requirement reads anywhere; without `keys` but for its keys."""
    own = requirement if keys else replace(requirement, for_each=None)
    return frozenset(names_of_requirement(own))


def is_touched(
    spec: CheckedSpec, requirement: Requirement, judged: Sequence[Sample], late: Sample
) -> bool:
    """Whether a sample that came too late might have changed what was judged of a requirement.

    Not its names alone say so: in sampled time it was a position, and before the first sample that
    was judged, where the trace would have begun.
    """
    if spec.time is TimeModel.SAMPLED or late.t < judged[0].t:
        return True
    return not names_read(requirement).isdisjoint(late.values)


def after_late(
    spec: CheckedSpec,
    verdicts: Mapping[str, Verdict],
    judged: Sequence[Sample],
    late: Sequence[Sample],
) -> dict[str, Verdict]:
    """The verdicts of a run to which samples came too late: of those touched only `F` stays.

    Source: SEMANTICS, section 6.
    """
    return {
        name: Verdict.INCONCLUSIVE
        if verdict is not Verdict.FAIL
        and any(is_touched(spec, spec.requirements[name], judged, one) for one in late)
        else verdict
        for name, verdict in verdicts.items()
    }
