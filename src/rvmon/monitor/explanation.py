"""Explains undecided attempts: their open obligations, and the unknown input behind them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import NamedTuple, Protocol

from msgspec import Struct
from msgspec.structs import replace

from rvmon.language.checked.specification import EndPolicy
from rvmon.language.print import format_duration
from rvmon.logic.automaton import FAILED, Token
from rvmon.logic.formula import horizon
from rvmon.logic.state_formula import TRUE, UNKNOWN
from rvmon.monitor.compile import CompiledRequirement
from rvmon.trace.sample import HealthKind, Scalar
from rvmon.trace.time import format_instant, format_ticks
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Blame, Decision


class Outage(Struct, frozen=True, eq=False):
    """A stretch over which a signal or event was unknown; the next value ends it."""

    name: str
    # the reason; `MISSING` if there was no value yet, `ABSENT` if there is no source
    why: HealthKind
    since: int = 0  # its first instant, ticks; meaningless for `MISSING` and `ABSENT`
    # the instant at which it was known again, ticks; `None` if it still is unknown
    until: int | None = None
    bound: int = 0  # for `stale after D`, D in ticks


class Doubt(Struct, frozen=True):
    """Why the pessimistic and the optimistic run of an attempt diverged: what was unknown."""

    origin: int  # the first instant of the run, ticks
    position: int  # the instant of their divergence, ticks
    # the outages of the signals and events involved; their ends may become known later
    outages: tuple[Outage, ...]
    texts: tuple[str, ...]  # the propositions that were unknown although all their inputs are known

    def __str__(self) -> str:
        """The clauses of an explanation, separated by semicolons.

        >>> second = 10**9
        >>> stale = Outage("far", HealthKind.STALE, second + 1, 4 * second, second // 2)
        >>> print(Doubt(0, 2 * second, (stale,), ()))
        `far` was not known from 1 s to 4 s: no update for 500 ms (stale)
        """
        causes = [outage_in_words(outage, self.origin) for outage in self.outages]
        at = format_instant(self.position, self.origin)
        causes += [f"`{text}` was not known at {at}" for text in self.texts]
        return "; ".join(causes) or f"an earlier unknown value still mattered at {at}"


def outage_in_words(outage: Outage, origin: int) -> str:
    """From when to when a signal was unknown, and why; instants relative to `origin` (ticks)."""
    name = f"`{outage.name}`"
    if outage.why is HealthKind.ABSENT:
        return f"{name} has no source"
    if outage.why is HealthKind.MISSING:
        if outage.until is None:
            return f"{name} never had a value"
        return f"{name} had no value before {format_instant(outage.until, origin)}"
    # A signal is stale from one tick after its time limit: show the limit.
    since = format_instant(outage.since - (outage.why is HealthKind.STALE), origin)
    end = "on" if outage.until is None else f"to {format_instant(outage.until, origin)}"
    match outage.why:
        case HealthKind.STALE:
            why = f"no update for {format_duration(outage.bound)} (stale)"
        case HealthKind.NAN:
            why = f"NaN at {since}"
        case HealthKind.NONE:
            why = f"given as unknown at {since}"
        case _:
            raise AssertionError(f"{outage.why} makes no signal unknown")
    return f"{name} was not known from {since} {end}: {why}"


class Explanation(NamedTuple):
    """The explanatory fields of a record; see `rvmon.verdicts.attempt.Attempt`."""

    reason: str = ""
    required: str = ""
    deadline: int | None = None
    blame: Blame | None = None


def unborn_of(
    names: Iterable[str], outages: Mapping[str, Outage], doubt: Doubt | None
) -> tuple[Outage, ...]:
    """The names that have had no value so far, except those that `doubt` already mentions."""
    named = set() if doubt is None else {outage.name for outage in doubt.outages}
    missing = (outages[name] for name in sorted(set(names) & outages.keys() - named))
    return tuple(outage for outage in missing if outage.why is HealthKind.MISSING)


@lru_cache(maxsize=1024)
def truths_shown(texts: tuple[str, ...], seen: tuple[int, ...]) -> Mapping[str, Scalar]:
    """Truth values by the text of the proposition; `None` is unknown, the last of equal texts wins.

    Cached, as few combinations occur in a recording. The result is shared: hand out copies only.
    """
    pairs = zip(texts, seen, strict=True)
    return {text: None if truth == UNKNOWN else truth == TRUE for text, truth in pairs}


class Undecided(Struct, frozen=True):
    """The state of an undecided attempt."""

    compiled: CompiledRequirement  # the requirement, or the judge of its attempts in doubt
    origin: int  # the first instant of the run, ticks
    triggered: int  # the instant of its trigger, ticks
    worse: Token  # state of the pessimistic run, which reads UNKNOWN as the worse value
    better: Token  # state of the optimistic run
    # the instant and reason of their divergence, or why the trigger itself is in doubt
    doubt: Doubt | None
    unborn: tuple[Outage, ...]  # the names it reads that have had no value so far
    sure: bool  # whether its trigger was TRUE, so that it is not in doubt
    # whether it cannot pass, as its episode ended before all its signals were born
    cannot_pass: bool
    cut: bool  # whether its captured values are no longer certain


Alone = tuple[int, bool] | None
"""The last instant before time alone decides a run, and its value; `None` if it never does."""


class Judged(Protocol):
    """The judge of an attempt (automaton or network), in its state at a stamp."""

    def required(self, attempt: Undecided, now: int, *, optimistic: bool) -> str | None:
        """What the optimistic or pessimistic run still requires; `None` if the run is decided."""

    def alone(self, attempt: Undecided) -> tuple[Alone, Alone]:
        """How time alone would decide the pessimistic and the optimistic run."""

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """The verdict under every continuation; `None` if continuations differ, or if unknown."""


def why_open(judged: Judged, attempt: Undecided, now: int, end: int | None = None) -> Explanation:
    """Why an attempt is undecided; an attempt in doubt has no deadline, as it cannot fail.

    `now` is twice the present instant in ticks, plus one if its letter is known; `end` is the last
    instant of the trace, if it has ended.
    """
    if attempt.sure:
        why = _obligation(judged, attempt, now, end)
        # Obligations on unborn signals do not fail, and time alone gives such signals no value.
        is_unborn = attempt.cannot_pass and not attempt.cut
        return why._replace(deadline=None) if is_unborn else why
    if attempt.worse[0] == FAILED:
        cause = f"; {attempt.doubt}" if attempt.doubt else ""
        return Explanation(f"it is not known whether there was a trigger{cause}")
    alone = replace(attempt, better=attempt.worse, cannot_pass=False)
    return _obligation(judged, alone, now, end)._replace(deadline=None)


def _obligation(judged: Judged, attempt: Undecided, now: int, end: int | None) -> Explanation:
    """The open obligation of an attempt, or why none is left."""
    # The pessimistic run requires the most; once it has failed, only the optimistic run can still
    # say what is required.
    is_failed = attempt.worse[0] == FAILED
    required = judged.required(attempt, now, optimistic=is_failed)
    if required is None:
        return Explanation(f"left open by the input: {attempt.doubt}")
    origin, when, so_far = attempt.origin, "", " so far"
    if end is not None:
        when, so_far = f" when the recording ended at {format_instant(end, origin)}", ""
    clauses = [f"still required{when}: {required or 'the rest of the consequent'}"]
    deadline = _deadline(judged, attempt)
    clauses += [] if end is None or not attempt.sure else _longer(attempt, end, deadline)
    clauses += [] if attempt.doubt is None else [str(attempt.doubt)]
    clauses += [outage_in_words(outage, origin) + so_far for outage in attempt.unborn]
    return Explanation("; ".join(clauses), required, deadline)


def _longer(attempt: Undecided, end: int, deadline: int | None) -> list[str]:
    """By how much a longer trace would have decided an attempt, if that is certain."""
    reach = horizon(attempt.compiled.obligation.required)
    if reach is None:
        return ["it has no deadline"] if deadline is None else []
    latest = attempt.triggered + reach
    if latest <= end:
        return ["1 ns more would have decided it"]
    return [f"a recording more than {format_ticks(latest - end)} longer would have decided it"]


def _deadline(judged: Judged, attempt: Undecided) -> int | None:
    """The last instant before time alone decides an attempt; `None` if it never does.

    An attempt is decided once the pessimistic run passes or the optimistic run fails.
    """
    worse, better = judged.alone(attempt)
    instants = [worse[0]] if worse is not None and worse[1] and not attempt.cannot_pass else []
    instants += [better[0]] if better is not None and not better[1] else []
    return min(instants, default=None)


def forecast_of(judged: Judged, attempt: Undecided, now: int) -> Verdict | None:
    """The verdict under every continuation; `None` if unknown. `now` is as for `why_open`.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    return judged.forecast(attempt, now) if attempt.sure and not attempt.cannot_pass else None


def why_settled(decision: Decision, policy: EndPolicy) -> str:
    """The reason for an attempt that the end of the trace settled."""
    if decision is Decision.HELD_TO_END:
        return "held to the end of the trace"
    return f"settled by `at end: {policy}`"


def why_nothing(*, cut: bool) -> Explanation:
    """Why an attempt that has ended stays undecided, whatever follows."""
    if cut:
        return Explanation("it is not known which values it captured")
    return Explanation("it ended before all signals that it reads had a value")
