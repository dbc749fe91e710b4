"""Finds late responses while a recording is read: when they came after a missed deadline."""

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rvmon.analysis.late_arrival import awaitable, first_after, missed
from rvmon.analysis.truths import Plans, Question, Truth, look_through
from rvmon.language.checked import formula as formulas
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.operators import Tense
from rvmon.language.checked.specification import CheckedSpec, TimeModel
from rvmon.language.print import format_formula
from rvmon.recordings.last_updates import LastUpdates, first_of, last_of
from rvmon.trace.sample import Sample, Value

if TYPE_CHECKING:
    from rvmon.analysis.truths import Positions
    from rvmon.recordings.batch import Batch
    from rvmon.verdicts.attempt import Attempt

Key = tuple[str, int]  # the requirement and number of an attempt

_FEW = 256  # samples evaluated at once; few, because a late response mostly comes soon


class Arrivals:
    """Looks for awaited responses in a recording, from the deadline until they come.

    A search may start at any instant, from the last update of each signal. So only formulas
    without memory are searched for, see `is_of_moment`. Recordings with outages are not supported.
    """

    def __init__(self, spec: CheckedSpec, names: frozenset[str] | None) -> None:
        # by attempt, the instant of the response, ticks; `None` if it has not come so far
        self.arrived: dict[Key, int | None] = {}
        self._spec = spec
        self._names = names
        # by requirement and text of the awaiting subformula, the text of the awaited one
        self._awaited: dict[str, dict[str, str]] = {}
        awaited: dict[str, formulas.Formula] = {}
        for name, requirement in spec.requirements.items():
            if not requirement.captured:
                parts = awaitable(requirement)
                self._awaited[name] = {text: format_formula(part) for text, part in parts.items()}
                awaited |= zip(self._awaited[name].values(), parts.values(), strict=True)
        of_moment = [one for one in awaited.values() if is_of_moment(one, spec.time)]
        self._question = Question(tuple(of_moment))
        self._plans: Plans = {}
        signals = self._question.names & spec.signals.keys()
        self._updates = LastUpdates(signals, spec.ignoring)
        self._open: dict[str, list[tuple[int, Key]]] = {}
        self._since: int | None = None

    def ask(self, attempt: Attempt) -> None:
        """Start to look for the response that a failed attempt awaited, from its deadline on.

        `arrived` gets an entry for the attempt, `None` if it awaited nothing. It gets none, and the
        recording has to be searched again, if the deadline lies in pieces already taken, if the
        formula is not `is_of_moment`, or if the requirement captures values.
        """
        if attempt.requirement not in self._awaited:
            return
        key = attempt.requirement, attempt.number
        text = self._awaited[attempt.requirement].get(missed(attempt))
        if text is None:
            self.arrived[key] = None
            return
        assert attempt.blame is not None, "it missed a deadline"
        deadline = attempt.blame.window[1] or 0
        if text in self._question.texts and (self._since is None or deadline >= self._since):
            self.arrived[key] = None
            insort(self._open.setdefault(text, []), (deadline, key), key=lambda wait: wait[0])

    def take(self, pieces: Sequence[Batch | Sample], until: int) -> None:
        """Take the next pieces of the recording, which is then complete up to `until` (ticks)."""
        place = 0
        # Pieces before the next deadline are only added to the last updates, not evaluated.
        while self._open:
            at = min(waits[0][0] for waits in self._open.values())
            at = at if self._since is None else max(at, self._since)
            if at >= until:
                break
            passed = place
            while place < len(pieces) and last_of(pieces[place]) <= at:
                place += 1
            self._updates.add(pieces[passed:place])
            stop = _portion(pieces, place)
            end = first_of(pieces[stop]) - 1 if stop < len(pieces) else until
            self._look(pieces[place:stop], at, end)
            self._since = end
        self._updates.add(pieces[place:])
        self._since = until

    def _look(self, pieces: Sequence[Batch | Sample], at: int, until: int) -> None:
        """Search pieces for responses after `at`; the first piece may start before it."""
        ahead = self._before(at, pieces[0] if pieces else None)
        for piece in pieces:
            if isinstance(piece, Sample):
                ahead.append(piece)
            else:
                first = int(piece.times.searchsorted(at, "right"))
                ahead.append(piece.cut(first, len(piece.times)))
        question = self._question
        seen = look_through(self._spec, [question], ahead, until, self._names, self._plans)
        truths = dict(zip(question.texts, seen.truths(question), strict=True))
        for text in tuple(self._open):
            self._answer(text, truths[text], at, seen.positions)

    def _answer(self, text: str, truth: Truth, at: int, positions: Positions) -> None:
        """Record the responses for the attempts that wait for a formula."""
        waits = self._open[text]
        answered = 0
        for deadline, key in waits:
            came = first_after(max(deadline, at), truth.true, positions)
            if came is None:
                break
            self.arrived[key] = came
            answered += 1
        del waits[:answered]
        if not waits:
            del self._open[text]

    def _before(self, at: int, piece: Batch | Sample | None) -> list[Batch | Sample]:
        """Samples with the last update of each signal up to an instant, and a sample there."""
        found: dict[int, dict[str, Value]] = {}
        for name, (t, value) in self._updates.until(at, piece).items():
            found.setdefault(t, {})[name] = value
        found.setdefault(at, {})
        return [Sample(t, found[t]) for t in sorted(found)]


def _portion(pieces: Sequence[Batch | Sample], place: int) -> int:
    """The end of the portion from `place` on that is searched next: a batch, or a few samples."""
    stop = place
    while stop < min(place + _FEW, len(pieces)) and isinstance(pieces[stop], Sample):
        stop += 1
    return max(stop, min(place + 1, len(pieces)))


def is_of_moment(formula: formulas.Formula, time: TimeModel) -> bool:
    """Whether the truth of a formula depends only on the last updates and the present sample.

    In clocked time events are excluded, because they count at a later instant.
    """
    return all(
        _is_of_moment(part) and (time is not TimeModel.CLOCKED or not _is_momentary(part))
        for part in subformulas(formula)
    )


def _is_of_moment(part: formulas.Formula) -> bool:
    match part:
        case formulas.Constant() | formulas.SignalAtom() | formulas.EventAtom():
            return True
        case formulas.ProbeAtom(probe=probe):
            return probe is not formulas.Probe.CHANGED
        case formulas.Compare(left=left, right=right):
            held = formulas.Literal, formulas.SignalValue, formulas.FieldValue, formulas.Arithmetic
            return all(isinstance(number, held) for number in formulas.numbers_in(left, right))
        case formulas.Unary(op=op) | formulas.Binary(op=op):
            return op.entry.tense is Tense.PRESENT
        case _:
            return False


def _is_momentary(part: formulas.Formula) -> bool:
    match part:
        case formulas.EventAtom():
            return True
        case formulas.ProbeAtom(probe=probe):
            return probe is not formulas.Probe.KNOWN
        case formulas.Compare(left=left, right=right):
            return any(formulas.fields_in(left, right))
        case _:
            return False
