"""What a record says beside the verdict, and sentences about attempts that are open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rvmon.formula.core import Core
from rvmon.formula.horizon import horizon
from rvmon.formula.state import TRUE, UNKNOWN
from rvmon.monitor.reasons.doubt import Doubt, Outage, outage_in_words
from rvmon.trace.health import HealthKind
from rvmon.trace.sample import Scalar
from rvmon.trace.time import format_ticks
from rvmon.verdict.attempt import Blame


@dataclass(frozen=True, slots=True)
class Explanation:
    """What a record says beside the verdict; see `rvmon.verdict.attempt.Attempt`."""

    reason: str = ""
    owed: str = ""
    deadline: int | None = None
    blame: Blame | None = None


def earlier(
    worse: tuple[int, bool] | None, better: tuple[int, bool] | None, *, void: bool
) -> int | None:
    """When two runs come to a decision: the one for the worse has to pass, or the other to fail.

    Args:
        worse: what time alone makes of the run that takes the unknown for the worse, and when.
        better: the same of the run that takes it for the better.
        void: whether the attempt does not pass.
    """
    found = [worse[0]] if worse is not None and worse[1] and not void else []
    found += [better[0]] if better is not None and not better[1] else []
    return min(found, default=None)


def still_owed(owed: str, end: int | None) -> str:
    """What an undecided attempt waits for, or waited for when the trace ended."""
    when = "" if end is None else f" when the recording ended at {format_ticks(end)}"
    return f"still owed{when}: {owed}"


def unborn_of(
    names: Iterable[str], outages: Mapping[str, Outage], doubt: Doubt | None
) -> tuple[Outage, ...]:
    """Which of some names have had no value so far; what has left the attempt open is named there.

    Args:
        names: that a requirement reads.
        outages: what is not known now.
        doubt: of the attempt.
    """
    told = set() if doubt is None else {one.name for one in doubt.outages}
    found = (outages[name] for name in sorted(set(names) & outages.keys() - told))
    return tuple(one for one in found if one.why is HealthKind.MISSING)


def unborn(outages: Sequence[Outage], end: int | None) -> str:
    """Which of what a requirement reads has had no value so far: nothing holds of it, or fails."""
    ended = "" if end is not None else " so far"
    return "".join(f"; {outage_in_words(one)}{ended}" for one in outages)


def longer(owed: Core, triggered: int, end: int | None) -> str:
    """How much longer a trace that has ended would decide an attempt, whatever it brings."""
    if end is None:
        return ""
    reach = horizon(owed)
    if reach is None:
        return "; it has no deadline"
    latest = triggered + reach
    if latest <= end:
        return "; 1 ns more would have decided it"
    return f"; a recording more than {format_ticks(latest - end)} longer would have decided it"


def truths_shown(texts: Sequence[str], seen: tuple[int, ...]) -> dict[str, Scalar]:
    """Truth values by the text of what has them; `None` is unknown."""
    pairs = zip(texts, seen, strict=True)
    return {text: None if truth == UNKNOWN else truth == TRUE for text, truth in pairs}
