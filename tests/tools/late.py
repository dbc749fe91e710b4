"""Too late (SEMANTICS 6): what a sample that came behind what was judged leaves of the verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.spec.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.testing.law.sample_words import heard
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


def stretch_of(
    spec: CheckedSpec, name: str, judged: Sequence[Sample], late: Sample
) -> tuple[int, int | None]:
    """The first and last instant at which what was judged of a name may be wrong.

    Of an event it is the stamp of what came too late; in clocked time it counts at the next tick.
    Of a signal it reaches past the next update: that one would have been a change, the difference
    to it another, and it was no birth if the late one was. So it ends before the first update that
    comes behind a known one; `None`: not at all.

    Args:
        spec: gives the time model and the signals.
        name: one that the late sample speaks of.
        judged: the samples that were.
        late: the one that was not.
    """
    tick = (spec.period or 1) if spec.time is TimeModel.CLOCKED else 1
    first = -(-late.t // tick) * tick
    if name in spec.events:
        return first, first
    updates = [
        (sample.t, sample.values[name])
        for sample in heard(spec, judged)
        if sample.t > late.t and name in sample.values
    ]
    known = [t for t, value in updates if value is not None and value == value]
    behind = (t for t, _ in updates if known and t > known[0])
    last = next(behind, None)
    if last is None:
        return first, None
    # Both may fall to one tick of a clock, which then sees the known one, too.
    return first, max(-(-known[0] // tick) * tick, -(-last // tick) * tick - 1)
