"""Finds when attempts are decided, and where an episode continues after a failure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from rvmon.errors import RvmonError
from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.language.checked.specification import Mode, Requirement
from rvmon.testing.law.attempts import (
    Start,
    View,
    counts_in_favour,
    is_pulse,
    obligation,
    starts_upon,
    views,
)
from rvmon.testing.law.syntax import by_and_or, is_upon_end, looks_back_at_future, speaks_of_future
from rvmon.testing.law.word import Truth, Word


@dataclass(slots=True, eq=False)
class Followed:
    """An attempt, and the first instant at which a prefix of the trace decides it."""

    start: Start
    # instant (ticks) and truth; `None` if no prefix decides it
    decided: tuple[int, Truth] | None = None
    # its number among the attempts whose trigger was TRUE somewhere, in the order of the first such
    # positions; 0 for an attempt in doubt
    number: int = 0
    # its number among the attempts whose trigger was not TRUE at their start, in the order of
    # starts; 0 for all others
    doubtful_number: int = 0


@dataclass(frozen=True, slots=True)
class Followings:
    """The attempts of one requirement, followed to their decisions, in the order of their starts.

    Its trigger `is_determined` if it was ever TRUE or FALSE.
    """

    attempts: Sequence[Followed]
    is_determined: bool


def follow(requirement: Requirement, word: Word) -> Followings:
    """The attempts of a requirement on a word.

    Raises:
        RvmonError: the requirement's `pulse` disagrees with the syntax of its trigger.

    Source: SEMANTICS, section 3; decision records 1 (Triggers, `whenever`, `for each`) and 4.
    """
    if is_pulse(requirement.trigger) != requirement.pulse:
        raise RvmonError(f"requirement {requirement.id}: its trigger's class is not its syntax's")
    seen = views(requirement, word)
    found = sorted(
        (followed for view in seen for followed in _followed(view)),
        key=lambda followed: followed.start.position,
    )
    sure = [followed for followed in found if followed.start.sure is not None]
    for number, followed in enumerate(
        sorted(sure, key=lambda followed: followed.start.sure or 0), start=1
    ):
        followed.number = number
    doubtful = (followed for followed in found if followed.start.sure != followed.start.position)
    for number, followed in enumerate(doubtful, start=1):
        followed.doubtful_number = number
    return Followings(found, any(view.is_determined for view in seen))


def _followed(view: View) -> list[Followed]:
    if not view.word.letters:
        return []
    by_edges = view.requirement.mode is Mode.UPON or is_upon_end(view.requirement)
    if not by_edges:
        return _episodes(view)
    found = [Followed(start) for start in starts_upon(view)]
    first = view.word.letters[0].instant
    if found:
        readings = view.readings()
        for reached in range(first, view.word.reached + 1):
            readings.reach(reached)
            _decide(found, view, reached)
    return found


def _decide(attempts: Iterable[Followed], view: View, reached: int) -> None:
    """Record the decisions of attempts that the prefix known at an instant decides."""
    for attempt in attempts:
        if attempt.decided is None and attempt.start.triggered <= reached:
            truth = obligation(attempt.start, view.readings())
            if truth is not Truth.UNKNOWN:
                attempt.decided = (reached, truth)


def _episodes(view: View) -> list[Followed]:
    """The attempts of a `whenever`: after a failure its episode continues as a new attempt."""
    requirement, letters, readings = view.requirement, view.word.letters, view.readings()
    at_once = opened_at_once(requirement.consequent)
    continues = not looks_back_at_future(requirement.consequent)
    favour = counts_in_favour(requirement)
    found: list[Followed] = []
    episode: Start | None = None
    position = 0
    for reached in range(letters[0].instant, view.word.reached + 1):
        readings.reach(reached)
        if position < len(letters) and letters[position].instant == reached:
            k, position = position, position + 1
            if view.trigger[k] is Truth.FALSE:
                episode = None
            elif episode is None and k >= view.first:
                positions, stop = view.stretch(k)
                episode = view.start_at(k, positions, stop)
                found.append(Followed(episode))
            elif episode is not None and continues and _has_failed(found[-1]):
                truths = readings.of(episode.captured, favour=favour)
                blurred = episode.blurred is not None and k >= episode.blurred
                if not blurred and truths.truth(at_once, k) is not Truth.FALSE:
                    found.append(Followed(episode.restarted(k)))
        _decide(found, view, reached)
    return found


def _has_failed(followed: Followed) -> bool:
    return followed.decided is not None and followed.decided[1] is Truth.FALSE


_RELEASES = {UnaryOp.ALWAYS, BinaryOp.RELEASE, BinaryOp.WEAK_UNTIL}
_UNTILS = {UnaryOp.EVENTUALLY, BinaryOp.UNTIL, BinaryOp.STRONG_RELEASE}


def opened_at_once(formula: Formula, *, positive: bool = True) -> Formula:
    """The formula with the windows of all `G` and `R` opened at once: their lower bounds become 0.

    In negation normal form, that is, so under a negation the windows of `F` and `U` are opened.

    Args:
        formula: a consequent or a part of one, without future operators below past ones.
        positive: whether the formula is under an even number of negations.

    Source: SEMANTICS, section 3 (After a failure).
    """
    if not speaks_of_future(formula) or not isinstance(formula, Unary | Binary):
        return formula
    lasting = _RELEASES if positive else _UNTILS
    interval = formula.interval
    if formula.op in lasting and interval is not None:
        interval = Interval(0, interval.high)
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return Unary(UnaryOp.NOT, opened_at_once(operand, positive=not positive))
        case Unary(operand=operand):
            opened = opened_at_once(operand, positive=positive)
            return replace(formula, operand=opened, interval=interval)
        case Binary() if (spelled := by_and_or(formula)) is not formula:
            return opened_at_once(spelled, positive=positive)
        case Binary():
            sides = formula.left, formula.right
            left, right = (opened_at_once(side, positive=positive) for side in sides)
            return replace(formula, left=left, right=right, interval=interval)
