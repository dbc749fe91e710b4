"""Reports on runs of the core; a raw record becomes an `Attempt` only on access."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rvmon import native
from rvmon.monitor.packed_plan import PlannedCore
from rvmon.trace.sample import Health
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.attempt import DECISIONS, VERDICTS, Attempt, Decision, LazyAttempts
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.notes import Note

_OPEN = DECISIONS.index(Decision.OPEN)

RECORD = np.dtype(
    [
        *((name, np.int64) for name in ("triggered", "decided", "captured", "note")),
        *(("requirement", np.int32), ("number", np.uint32)),
        *((name, np.uint8) for name in ("verdict", "decision", "in_doubt")),
    ],
    align=True,
)
"""`rv_record` of `core.h`."""

NUMBER = np.dtype([("kind", np.int32), ("bits", np.int64)], align=True)
"""`rv_number` of `core.h`; the bits of an int64 or of a double."""

_WHOLE, _REAL = 1, 2

_TOGETHER = 4096  # records converted to Python numbers at once

_MOST_EXPLAINED = 256
"""The most explanations cached per run. The failure analysis, the text output and each report file
read the same attempts; a run may have millions."""


class RecordedAttempts(LazyAttempts):
    """The attempts of a run, made from raw records on access; explained when details are read.

    Args:
        planned: the plan of the run; `None` if `give_plan` sets it later.
        records: `RECORD[n]`, in the order of reports.
        numbers: `NUMBER[n, most]`, the captured values.
        notes: the notes of the records as bytes, and the letters that the notes refer to.
        origin: the first instant of the run, ticks.
    """

    def __init__(
        self,
        planned: PlannedCore | None,
        records: NDArray[Any],
        numbers: NDArray[Any],
        notes: tuple[bytes, Sequence[tuple[Any, bytes, int]]],
        origin: int,
    ) -> None:
        self.given = planned
        self._origin = origin
        self._notes = notes
        self._records = records
        self._numbers = numbers
        self._explained: dict[tuple[str, int, bool], Mapping[str, Any]] = {}

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        """Pickle without the cached explanations; the receiver makes them again.

        Arrays are pickled as bytes, as each would otherwise carry a description of its dtype.
        """
        records, numbers = self._records.tobytes(), self._numbers.tobytes()
        return _unpickled, (self.given, records, numbers, self._notes, self._origin)

    @property
    def _planned(self) -> PlannedCore:
        assert self.given is not None, "whoever takes them from another process gives the plan"
        return self.given

    def __len__(self) -> int:
        return len(self._records)

    @overload
    def __getitem__(self, index: int) -> Attempt: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Attempt]: ...
    def __getitem__(self, index: int | slice) -> Attempt | Sequence[Attempt]:
        if isinstance(index, slice):
            chosen = self._records[index], self._numbers[index]
            return RecordedAttempts(self.given, *chosen, self._notes, self._origin)
        return self._attempt(self._records[index].tolist(), self._numbers[index])

    def __iter__(self) -> Iterator[Attempt]:
        for first in range(0, len(self._records), _TOGETHER):
            stop = first + _TOGETHER
            yield from map(
                self._attempt, self._records[first:stop].tolist(), self._numbers[first:stop]
            )

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """See `LazyAttempts`."""
        number = self._planned.packed.numbers.get(requirement)
        if number is None:
            return iter(())
        kind = number * len(VERDICTS) + VERDICTS.index(verdict)
        kinds, order = self._by_kind
        first, stop = kinds.searchsorted([kind, kind + 1]).tolist()
        return self._each(order[first:stop])

    def _each(self, places: NDArray[np.intp]) -> Iterator[Attempt]:
        """The attempts at some places, in batches that double: often only the first are read."""
        first, count = 0, 1
        while first < len(places):
            some = places[first : first + count]
            yield from map(self._attempt, self._records[some].tolist(), self._numbers[some])
            first, count = first + count, min(2 * count, _TOGETHER)

    @cached_property
    def _by_kind(self) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """The keys requirement × `len(VERDICTS)` + verdict, sorted, and the record of each."""
        kinds = self._records["requirement"].astype(np.int64) * len(VERDICTS)
        kinds += self._records["verdict"]
        order = np.argsort(kinds, kind="stable")
        return kinds[order], order

    def _attempt(self, record: Sequence[int], numbers: NDArray[Any]) -> Attempt:
        triggered, decided, captured, note, requirement, number, verdict, decision, in_doubt = (
            record
        )
        values = None if captured < 0 else tuple(map(_number_of, numbers))
        attempt = Attempt.__new__(Attempt)
        attempt.requirement = self._planned.packed.ids[requirement]
        attempt.number = number
        attempt.triggered = triggered
        attempt.decided = None if decision == _OPEN else decided
        attempt.verdict = VERDICTS[verdict]
        attempt.decision = DECISIONS[decision]
        attempt.in_doubt = bool(in_doubt)
        attempt.origin = self._origin
        attempt._details = self._details
        attempt._noted = values, note
        return attempt

    def _details(
        self, attempt: Attempt, noted: tuple[Sequence[float | None] | None, int], name: str
    ) -> Mapping[str, Any]:
        """See `PlannedCore.details`."""
        captured, place = noted
        key = attempt.requirement, attempt.number, attempt.in_doubt
        kept = self._explained.get(key)
        if kept is not None and name in kept:
            return kept

        def note() -> Note:
            from rvmon.monitor.notes import note_at

            return note_at(self._notes[0], place, self._notes[1])

        found = self._planned.details(attempt, captured, note, name)
        if kept is not None or len(self._explained) < _MOST_EXPLAINED:
            self._explained[key] = found
        return found


def _number_of(number: Any) -> float | None:
    """A captured value; `None` if it is unknown."""
    kind = number["kind"]
    if kind == _WHOLE:
        return int(number["bits"])
    return float(number["bits"].view(np.float64)) if kind == _REAL else None


def recorded(
    planned: PlannedCore, raw: tuple[bytes, bytes, bytes, Any], origin: int
) -> RecordedAttempts:
    """The decided attempts among raw records, in the same order.

    `raw` holds records, captured numbers, notes and letters, as the core returns them.
    """
    records, numbers, words, letters = raw
    attempts, captured = _arrays(records, numbers)
    settled = attempts["decision"] != _OPEN
    if not settled.all():
        attempts, captured = attempts[settled], captured[settled]
    return RecordedAttempts(planned, attempts, captured, (words, letters), origin)


def _unpickled(
    planned: PlannedCore | None, records: bytes, numbers: bytes, notes: Any, origin: int
) -> RecordedAttempts:
    return RecordedAttempts(planned, *_arrays(records, numbers), notes, origin)


def _arrays(records: bytes, numbers: bytes) -> tuple[NDArray[Any], NDArray[Any]]:
    """`RECORD[n]` and `NUMBER[n, most]` from their bytes."""
    found = np.frombuffer(records, RECORD)
    captured = np.frombuffer(numbers, NUMBER).reshape(len(found), -1 if len(found) else 0)
    return found, captured


def give_plan(report: Report, planned: PlannedCore | None) -> Report:
    """Set the plan that explains the attempts of a report; returns the report.

    Args:
        report: the report of a recording.
        planned: a plan of the same requirements. `None` drops the plan before another process
            takes the report and sets its own, as a plan may be larger than everything else.
    """
    if isinstance(report.attempts, RecordedAttempts):
        report.attempts.given = planned
    return report


def report_of_run(
    planned: PlannedCore,
    run: native.Monitor,
    origin: int,
    end: int | None,
    health: tuple[Health, ...] = (),
) -> Report:
    """Sort and fold the records of a run, as `rvmon.verdicts.report.report_of` does with attempts.

    `origin` is the instant that reports show as 0 s, `end` the last one of the trace (ticks).

    Source: SEMANTICS, section 3.
    """
    ids = planned.packed.ids
    verdicts: dict[str, Verdict] = {}
    counts: dict[str, dict[Verdict, int]] = {}
    for name, (failed, passed, inconclusive, complete) in zip(ids, run.counts(), strict=True):
        counted = {Verdict.PASS: passed, Verdict.FAIL: failed, Verdict.INCONCLUSIVE: inconclusive}
        counts[name] = counted
        some = [verdict for verdict, count in counted.items() if count]
        verdicts[name] = fold(some, complete=bool(complete))
    records, numbers, words, letters = run.records()
    attempts, captured = _arrays(records, numbers)
    order = _order(attempts)
    return Report(
        verdicts=verdicts,
        attempts=RecordedAttempts(
            planned,
            attempts if order is None else attempts[order],
            captured if order is None else captured[order],
            (words, letters),
            origin,
        ),
        counts=counts,
        health=health,
        dropped=_dropped(ids, counts, attempts),
        origin=origin,
        end=end,
    )


def _dropped(
    ids: Sequence[str], counts: Mapping[str, Mapping[Verdict, int]], records: NDArray[Any]
) -> Mapping[str, Mapping[Verdict, int]]:
    """By requirement and verdict, the number of attempts that were counted but not kept."""
    if sum(sum(of_requirement.values()) for of_requirement in counts.values()) == len(records):
        return {}
    there = np.bincount(
        records["requirement"] * len(VERDICTS) + records["verdict"],
        minlength=len(ids) * len(VERDICTS),
    ).reshape(-1, len(VERDICTS))
    dropped = {
        name: {
            verdict: left
            for verdict, count in of_requirement.items()
            if (left := count - there[row, VERDICTS.index(verdict)].item())
        }
        for row, (name, of_requirement) in enumerate(counts.items())
    }
    return {name: some for name, some in dropped.items() if some}


def _order(records: NDArray[Any]) -> NDArray[np.intp] | None:
    """The permutation into report order; `None` if the records are already in order.

    Keys: decision instant (undecided last), requirement, in doubt, number.
    """
    if len(records) < 2:
        return None
    undecided = records["decision"] == _OPEN
    decided = np.where(undecided, np.iinfo(np.int64).max, records["decided"])
    if (decided[1:] > decided[:-1]).all():
        return None
    keys = (records["number"], records["in_doubt"], records["requirement"], decided)
    return np.lexsort(keys)
