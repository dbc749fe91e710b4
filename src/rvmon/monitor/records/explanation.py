"""What a record says beside the verdict, and sentences about attempts that are open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.formula.horizon import horizon
from rvmon.formula.state import TRUE, UNKNOWN
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.reasons.doubt import outage_in_words
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
    attempt: Open, worse: tuple[int, bool] | None, better: tuple[int, bool] | None
) -> int | None:
    """When two runs come to a decision: the one for the worse has to pass, or the other to fail.

    Args:
        attempt: whose they are; one that is void does not pass.
        worse: what time alone makes of the run that takes the unknown for the worse, and when.
        better: the same of the run that takes it for the better.
    """
    found = [worse[0]] if worse is not None and worse[1] and not attempt.void else []
    found += [better[0]] if better is not None and not better[1] else []
    return min(found, default=None)


def still_owed(owed: str, end: int | None) -> str:
    """What an undecided attempt waits for, or waited for when the trace ended."""
    when = "" if end is None else f" when the recording ended at {format_ticks(end)}"
    return f"still owed{when}: {owed}"


def unborn(judge: AttemptJudge, attempt: Open, end: int | None) -> str:
    """Which of what a requirement reads has had no value so far: nothing holds of it, or fails.

    What has left the attempt open is named there.
    """
    reads, outages = judge.flow.graph.reads, judge.flow.outages
    names = {name for place, _ in judge.leaves for name in reads[place].names & outages.keys()}
    if attempt.doubt is not None:
        names -= {one.name for one in attempt.doubt.outages}
    found = [outages[name] for name in sorted(names)]
    ended = "" if end is not None else " so far"
    return "".join(
        f"; {outage_in_words(one)}{ended}" for one in found if one.why is HealthKind.MISSING
    )


def longer(judge: AttemptJudge, attempt: Open, end: int | None) -> str:
    """How much longer a trace that has ended would decide an attempt, whatever it brings."""
    if end is None:
        return ""
    reach = horizon(judge.compiled.obligation.owed)
    if reach is None:
        return "; it has no deadline"
    latest = attempt.triggered + reach
    if latest <= end:
        return "; 1 ns more would have decided it"
    return f"; a recording more than {format_ticks(latest - end)} longer would have decided it"


def truths_shown(texts: Sequence[str], seen: tuple[int, ...]) -> dict[str, Scalar]:
    """Truth values by the text of what has them; `None` is unknown."""
    pairs = zip(texts, seen, strict=True)
    return {text: None if truth == UNKNOWN else truth == TRUE for text, truth in pairs}
