"""The robustness of attempts, computed from its definition.

Every position is explicit, and every operator is a minimum of maxima over positions. Each figure is
an interval, as unknown input and all input after the end may be anything. Possible positions divide
a trace into pieces: outside the piece in which an attempt starts, input may be anything, too.
"""

from __future__ import annotations

from collections.abc import Container, Mapping

from rvmon.language.checked.specification import Mode, TimeModel
from rvmon.testing.law.attempts import Start, counts_in_favour
from rvmon.testing.law.decisions import Followings
from rvmon.testing.law.ranges import ANY, TOP, Margins, Range, least, most, negated
from rvmon.testing.law.syntax import is_upon_end
from rvmon.testing.law.word import Rest, Truth, Word

Key = tuple[str, bool, int]
"""Requirement, whether the attempt is in doubt, and its number."""


def margins(
    followings: Mapping[str, Followings], recorded: Container[Key], time: TimeModel
) -> dict[Key, tuple[float, float, float]]:
    """The robustness of attempts.

    Args:
        followings: the attempts by requirement.
        recorded: the attempts with a record; all others are left out.
        time: the time model.

    Returns:
        Lower bound, upper bound, and the lower bound if after the end every opened unbounded `R`
        (`always`) holds. The upper bound of an attempt in doubt is infinite, as it may not have
        been triggered and then has no obligation.

    Source: SEMANTICS, sections 1 (Birth), 2, 3 and 5.
    """
    held = time is TimeModel.HELD
    found = {}
    for name, own in followings.items():
        for attempt in own.attempts:
            in_doubt = attempt.start.sure is None
            key = (name, in_doubt, attempt.doubtful_number if in_doubt else attempt.number)
            if key in recorded:
                low, high = _required(attempt.start, kept=False, held=held)
                kept, _ = _required(attempt.start, kept=True, held=held)
                found[key] = (low, TOP[1] if in_doubt else high, kept)
    return found


def _piece(word: Word, position: int) -> tuple[Word, int]:
    """The piece of certain positions around one: the word up to its end, and its first position."""
    letters = word.letters
    last = next((k for k in range(position, len(letters)) if not letters[k].sure), None)
    first = next((k + 1 for k in reversed(range(position)) if not letters[k].sure), 0)
    if last is None:
        return word, first
    return Word(letters[:last], None, letters[last].instant), first


def _required(start: Start, *, kept: bool, held: bool) -> Range:
    requirement = start.view.requirement
    favour = counts_in_favour(requirement)
    if not start.word.letters[start.position].sure:
        return ANY
    word, first = _piece(start.word, start.position)
    positions = [k for k in start.positions if k < len(word.letters)]
    over = start.stop is not None and start.stop < len(word.letters)
    rest = Rest.END if kept else Rest.UNKNOWN
    found = Margins(word, start.captured, first, rest, held=held, favour=favour)

    def consequent(k: int) -> Range:
        return found.required(requirement.consequent, k)

    if is_upon_end(requirement) or (requirement.mode is Mode.UPON and start.sure is not None):
        return consequent(start.position)

    def required(k: int) -> Range:
        if start.blurred is not None and k >= start.blurred:
            return ANY
        if requirement.mode is Mode.UPON:
            return most([ANY, consequent(k)])
        excused = negated(found.state(requirement.trigger, k).ranges[Truth.FALSE])
        return most([excused, consequent(k)])

    end = over or (kept and len(word.letters) == len(start.word.letters))
    return least([*map(required, positions), TOP if end else ANY])
