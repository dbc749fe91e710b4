"""Too late (SEMANTICS 6): what a sample that came behind what was judged leaves of the verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.spec.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.trace.sample import Sample
from rvmon.verdict import Verdict
from tests.tools.law import names_read


def is_touched(
    spec: CheckedSpec, requirement: Requirement, judged: Sequence[Sample], late: Sample
) -> bool:
    """Whether a sample that came too late might have changed what was judged of a requirement.

    Not its names alone say so: in sampled time it was a position, and before the first sample that
    was judged, where the trace would have begun.

    Args:
        spec: gives the time model.
        requirement: one of it.
        judged: the samples that were.
        late: the one that was not.
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

    Args:
        spec: of the run.
        verdicts: without what came too late.
        judged: the samples that were.
        late: those that were not.

    Source: SEMANTICS, section 6.
    """
    return {
        name: Verdict.INCONCLUSIVE
        if verdict is not Verdict.FAIL
        and any(is_touched(spec, spec.requirements[name], judged, one) for one in late)
        else verdict
        for name, verdict in verdicts.items()
    }
