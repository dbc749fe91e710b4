"""How far a run has come after each call."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rvmon.language.checked.specification import TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known of a trace at some moment.

    Attributes:
        end: the last instant whose letter is known.
        reached: the instant that time is known to have come to.
    """

    end: int
    reached: int


def moments(case: Case, *, settle: str = "now") -> Iterator[Moment | None]:
    """After each action of a case, what a monitor knows; `None` before it knows a letter.

    Args:
        case: what it is told.
        settle: `now`, or `next`: a sample counts once the time of another call is behind it.

    Source: SEMANTICS 6; decision record 1 (What is known of a trace at a moment).
    """
    last: int | None = None
    waiting: int | None = None
    reached: int | None = None
    for action in case.actions:
        t = action.t if isinstance(action, Sample) else action
        if waiting is not None and waiting < t:
            last, waiting = waiting, None
        if isinstance(action, Sample) and settle == "now":
            last = t
        elif isinstance(action, Sample):
            waiting = t
        reached = t if reached is None else max(reached, t)
        if last is None:
            yield None
        else:
            sampled = case.spec.time is TimeModel.SAMPLED
            yield Moment(last if sampled else max(last, reached - 1), reached)
