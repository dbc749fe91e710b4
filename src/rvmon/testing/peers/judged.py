"""A recording judged by a peer: its truth at the triggers against the verdicts of a report."""

from __future__ import annotations

from math import gcd

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Compare,
    EventAtom,
    FieldValue,
    Formula,
    Interval,
    ProbeAtom,
    Unary,
    UnaryOp,
    UpdateValue,
)
from rvmon.spec.checked.specification import Mode, Requirement, TimeModel
from rvmon.testing.case import Case
from rvmon.testing.law.walk import intervals, numerics, subformulas
from rvmon.testing.peers.client import Peer
from rvmon.testing.peers.core import names_in
from rvmon.testing.peers.ways import Cell, Way, truths
from rvmon.testing.scale import retimed
from rvmon.trace.time import format_ticks
from rvmon.verdict.attempt import Decision
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

MOST_TICKS = 2_000


class Unfit(Exception):  # noqa: N818 - no error: this recording is nothing for that peer
    """The peer cannot be asked about a requirement or recording; the text says why."""


def disagreements(way: Way, peer: Peer, case: Case, report: Report) -> list[str]:
    """Where a peer's truth at a trigger is another than the verdict of the attempt.

    Compared are attempts that the samples decided. An episode is asked for as `ψ W not θ`.

    Raises:
        Unfit: the peer's words are not like this recording.
        UntranslatableError: it cannot be asked this.
        PeerError: it refuses, or dies.
    """
    [requirement] = case.spec.requirements.values()
    if requirement.for_each is not None or requirement.captures:
        raise Unfit("`for each` and `let` are beyond peers")
    if case.spec.time is not way.time:
        raise Unfit(f"reads time as `{way.time.value}`")
    formula = _owed(requirement)
    grain = _grain(case, formula)
    asked = retimed(formula, lambda duration: duration // grain)
    columns = _columns(case, formula, grain)
    answers = truths(way, peer, asked, columns)
    first = case.samples[0].t
    found = []
    for attempt in report.attempts:
        theirs = answers[(attempt.triggered - first) // grain]
        if attempt.decision is not Decision.PREFIX or theirs is None:
            continue
        if theirs is not (attempt.verdict is Verdict.PASS):
            found.append(
                f"{attempt.requirement} #{attempt.number}: triggered at "
                f"{format_ticks(attempt.triggered)}, {attempt.verdict.value}; "
                f"the peer says {'true' if theirs else 'false'}"
            )
    return found


def _owed(requirement: Requirement) -> Formula:
    if requirement.mode is Mode.UPON:
        return requirement.consequent
    over = Unary(UnaryOp.NOT, requirement.trigger)
    return Binary(BinaryOp.WEAK_UNTIL, requirement.consequent, over, Interval(0, None))


def _grain(case: Case, formula: Formula) -> int:
    """The tick of the peer: one in which the recording is what it is tick for tick.

    In held time what signals are is constant between multiples of it, and so is all that is derived
    of them by windows whose ends are such multiples.
    """
    spec, first = case.spec, case.samples[0].t
    held = spec.time is TimeModel.HELD
    read = names_in(formula)
    moments = any(
        isinstance(part, EventAtom | ProbeAtom) or _reads_update(part)
        for part in subformulas(formula)
    )
    if moments and held:
        raise Unfit("an event, or an update, is no signal that is held")
    signals = [spec.signals[name] for name in read if name in spec.signals]
    if any(one.stale_after or one.ignores_nan for one in signals):
        raise Unfit("peers know nothing of `stale after` and `ignore NaN`")
    distances = [sample.t - first for sample in case.samples]
    distances += [bound for window in intervals(formula) for bound in _bounds(window)]
    if held and case.end is not None:
        distances.append(case.end - first)
    grain = gcd(*distances) or 1
    ticks = (max(case.samples[-1].t, case.end or 0) - first) // grain + 1
    if ticks > MOST_TICKS:
        raise Unfit(f"{ticks:,} ticks of {format_ticks(grain)}: too many")
    if not held and len(case.samples) * grain - grain != case.samples[-1].t - first:
        raise Unfit("its positions are evenly spaced, these are not")
    return grain


def _reads_update(part: Formula) -> bool:
    if not isinstance(part, Compare):
        return False
    return any(isinstance(one, UpdateValue | FieldValue) for one in numerics(part))


def _bounds(window: Interval) -> tuple[int, ...]:
    return (window.low,) if window.high is None else (window.low, window.high)


def _columns(case: Case, formula: Formula, grain: int) -> dict[str, list[Cell]]:
    """The value of each name at each tick."""
    first = case.samples[0].t
    last = case.samples[-1].t
    if case.spec.time is TimeModel.HELD:
        last = max(last, case.end or 0)
    ticks = (last - first) // grain + 1
    at = {(sample.t - first) // grain: sample.values for sample in case.samples}
    columns: dict[str, list[Cell]] = {}
    for name in sorted(names_in(formula)) or [next(iter(case.spec.signals), "row")]:
        event = name in case.spec.events
        column: list[Cell] = []
        value: object = None
        for tick in range(ticks):
            values = at.get(tick, {})
            if name in values:
                value = values[name]
            if event:
                column.append(values.get(name) not in (None, False))
                continue
            if not isinstance(value, bool | int | float) or value != value:
                raise Unfit(f"`{name}` is unknown at {format_ticks(first + tick * grain)}")
            column.append(value if isinstance(value, bool) else float(value))
        columns[name] = column
    return columns
