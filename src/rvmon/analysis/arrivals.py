"""When what a missed deadline awaited came after all, found as a recording goes by."""

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING

from rvmon.analysis.late_arrival import first_after, may_be_awaited
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

Key = tuple[str, int]  # the requirement and number of an attempt

_FEW = 256
"""Rows that are looked through at first, for each formula: mostly what was awaited comes soon."""


class Arrivals:
    """Looks out for what was awaited, from the deadline on and no further than until it came.

    A look begins at any instant, with the last update of each signal before it: so it takes only
    formulas of the moment, see `is_of_moment`. A recording with outages is none for it.
    """

    def __init__(self, spec: CheckedSpec, names: frozenset[str] | None) -> None:
        # by attempt the instant, ticks; `None`: it did not come so far
        self.found: dict[Key, int | None] = {}
        self._spec = spec
        self._names = names
        awaited = {
            format_formula(formula): formula
            for requirement in spec.requirements.values()
            if not (requirement.for_each or requirement.captures)
            for formula in may_be_awaited(requirement)
            if is_of_moment(formula, spec.time)
        }
        self._question = Question(tuple(awaited.values()))
        self._texts = set(awaited)
        self._plans: Plans = {}
        signals = self._question.names & spec.signals.keys()
        self._updates = LastUpdates(signals, spec.ignoring)
        self._open: dict[str, list[tuple[int, Key]]] = {}
        self._since: int | None = None
        self._first = self._rows = _FEW * len(awaited)

    def ask(self, key: Key, formula: formulas.Formula | None, deadline: int) -> None:
        """Look out for a formula from a deadline (ticks) on; `None`: nothing was awaited.

        Where the deadline is in what was taken, or the formula is none for this, `found` lacks it.
        """
        text = "" if formula is None else format_formula(formula)
        if formula is None:
            self.found[key] = None
        elif text in self._texts and (self._since is None or deadline >= self._since):
            self.found[key] = None
            insort(self._open.setdefault(text, []), (deadline, key), key=lambda wait: wait[0])

    def take(self, pieces: Sequence[Batch | Sample], until: int) -> None:
        """Take the next pieces of the recording, which tell all up to an instant (ticks)."""
        place = 0
        while self._open:
            at = min(waits[0][0] for waits in self._open.values())
            at = at if self._since is None else max(at, self._since)
            if at >= until:
                break
            passed = place
            while place < len(pieces) and last_of(pieces[place]) <= at:
                place += 1
            self._updates.add(pieces[passed:place])
            self._look(pieces, place, at, until)
        self._updates.add(pieces[place:])
        self._since = until

    def _look(self, pieces: Sequence[Batch | Sample], place: int, at: int, until: int) -> None:
        """Look through some rows behind an instant, in pieces from a place on."""
        ahead = self._before(at, pieces[place] if place < len(pieces) else None)
        left = self._rows
        for piece in islice(pieces, place, None):
            if left <= 0:
                until = first_of(piece) - 1
                break
            if isinstance(piece, Sample):
                ahead.append(piece)
                left -= 1
                continue
            times = piece.times
            first = int(times.searchsorted(at, "right"))
            stop = min(first + left, len(times))
            stop = int(times.searchsorted(times[stop - 1], "right"))  # an instant is not divided
            ahead.append(piece.cut(first, stop))
            left -= stop - first
            if stop < len(times):
                until = int(times[stop]) - 1
                break
        question = self._question
        seen = look_through(self._spec, [question], ahead, until, self._names, self._plans)
        truths = dict(zip(question.texts, seen.truths(question), strict=True))
        came = [self._answer(text, truths[text], at, seen.positions) for text in tuple(self._open)]
        self._rows = self._first if any(came) else 4 * self._rows
        self._since = until

    def _answer(self, text: str, truth: Truth, at: int, positions: Positions) -> bool:
        """Note what came of a formula that was true then; returns whether anything did."""
        waits = self._open[text]
        answered = 0
        for deadline, key in waits:
            came = first_after(max(deadline, at), truth.true, positions)
            if came is None:
                break
            self.found[key] = came
            answered += 1
        del waits[:answered]
        if not waits:
            del self._open[text]
        return answered > 0

    def _before(self, at: int, piece: Batch | Sample | None) -> list[Batch | Sample]:
        """Samples with the last update of each signal up to an instant, and one at that."""
        found: dict[int, dict[str, Value]] = {}
        for name, (t, value) in self._updates.until(at, piece).items():
            found.setdefault(t, {})[name] = value
        found.setdefault(at, {})
        return [Sample(t, found[t]) for t in sorted(found)]


def is_of_moment(formula: formulas.Formula, time: TimeModel) -> bool:
    """Whether its truth follows from the last update of each signal, and what comes at an instant.

    In clocked time an event counts at a later instant.
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
            return any(
                isinstance(number, formulas.FieldValue)
                for number in formulas.numbers_in(left, right)
            )
        case _:
            return False
