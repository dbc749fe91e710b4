"""Reports of the core's runs: their records become attempts when someone looks at them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rvmon import native
from rvmon.monitor.core.planned import DECISIONS, VERDICTS, PlannedCore
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.attempt_json import Pattern, attempt_text, numbers_texts
from rvmon.verdict.instants import seconds_of
from rvmon.verdict.lazy import LazyAttempts
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

if TYPE_CHECKING:
    from numpy.typing import NDArray

_OPEN = DECISIONS.index(Decision.OPEN)


RECORD = np.dtype(
    [
        *((name, np.int64) for name in ("triggered", "decided", "captured")),
        *(("requirement", np.int32), ("number", np.uint32)),
        *((name, np.uint8) for name in ("verdict", "decision", "in_doubt")),
    ],
    align=True,
)
"""`rv_record` of `core.h`."""

NUMBER = np.dtype([("kind", np.int32), ("bits", np.int64)], align=True)
"""`rv_number` of it; the bits are those of a whole number or of a double."""

_WHOLE, _REAL = 1, 2


class RecordedAttempts(LazyAttempts):
    """Attempts without reasons, made from the records of a run.

    Args:
        planned: the plan that it judged by.
        records: array of `RECORD`, in the order of reports.
        numbers: array of `NUMBER` [records, most], the values that they captured.
    """

    def __init__(self, planned: PlannedCore, records: NDArray[Any], numbers: NDArray[Any]) -> None:
        self._planned = planned
        self._ids = planned.packed.ids
        self._records = records
        self._numbers = numbers

    def __len__(self) -> int:
        return len(self._records)

    @overload
    def __getitem__(self, index: int) -> Attempt: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Attempt]: ...
    def __getitem__(self, index: int | slice) -> Attempt | Sequence[Attempt]:
        if isinstance(index, slice):
            return RecordedAttempts(self._planned, self._records[index], self._numbers[index])
        return self._attempt(self._records[index], self._numbers[index])

    def __iter__(self) -> Iterator[Attempt]:
        return map(self._attempt, self._records, self._numbers)

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """See `LazyAttempts`."""
        records = self._records
        own = records["requirement"] == self._ids.index(requirement)
        chosen = np.flatnonzero(own & (records["verdict"] == VERDICTS.index(verdict)))
        return (self[index] for index in chosen.tolist())

    def texts(self, origin: int) -> Iterator[tuple[str, str]]:
        """See `LazyAttempts`."""
        if self._numbers.size:
            return ((one.requirement, attempt_text(one, origin)) for one in self)
        return self._alike_texts(origin)

    def _alike_texts(self, origin: int) -> Iterator[tuple[str, str]]:
        records = self._records
        alike = records["requirement"].astype(np.int64)
        for name in ("verdict", "decision", "in_doubt"):
            alike = alike << 8 | records[name]
        texts = np.empty(len(records), object)
        for kind in set(alike.tolist()):  # these differ in numbers alone
            own = np.flatnonzero(alike == kind)
            columns: dict[str, Any] = {"number": records["number"][own].tolist()}
            for name in ("triggered", "decided"):
                instants = records[name][own]
                columns[name] = instants.tolist()
                columns[f"{name}_s"] = numbers_texts(seconds_of(instants, origin))
            texts[own] = Pattern(self[own.item(0)], [""]).texts(columns, [])
        return zip(map(self._ids.__getitem__, records["requirement"].tolist()), texts, strict=True)

    def _attempt(self, record: Any, numbers: NDArray[Any]) -> Attempt:
        triggered, decided, captured, requirement, number, verdict, decision, in_doubt = (
            record.tolist()
        )
        values = () if captured < 0 else tuple(map(_number_of, numbers))
        return Attempt(
            self._ids[requirement],
            number,
            triggered,
            None if decision == _OPEN else decided,
            VERDICTS[verdict],
            DECISIONS[decision],
            captured=self._planned.captured.of(requirement, values),
            in_doubt=bool(in_doubt),
        )


def _number_of(number: Any) -> float | None:
    """A captured value; `None`: it is not known."""
    kind = number["kind"]
    if kind == _WHOLE:
        return int(number["bits"])
    return float(number["bits"].view(np.float64)) if kind == _REAL else None


def report_of_run(
    planned: PlannedCore, run: native.Monitor, origin: int, end: int | None
) -> Report:
    """Sort and fold the records of a run, as `rvmon.verdict.report.report_of` does attempts.

    Args:
        planned: the plan that it judged by.
        run: is finished.
        origin: the instant from which people count seconds, ticks.
        end: the last instant of the trace, ticks.

    Source: SEMANTICS, section 3.
    """
    complete, counts = {}, {}
    for name, own in zip(planned.packed.ids, run.counts(), strict=True):
        *_, is_complete = own
        complete[name] = bool(is_complete)
        counts[name] = {verdict: own[VERDICTS.index(verdict)] for verdict in _COUNTED}
    records, numbers = run.records()
    made = np.frombuffer(records, RECORD)
    captured = np.frombuffer(numbers, NUMBER).reshape(len(made), -1 if len(made) else 0)
    order = _order(made)
    return Report(
        verdicts={
            name: fold([one for one, count in own.items() if count], complete=complete[name])
            for name, own in counts.items()
        },
        attempts=RecordedAttempts(planned, made, captured)
        if order is None
        else RecordedAttempts(planned, made[order], captured[order]),
        counts=counts,
        origin=origin,
        end=end,
    )


_COUNTED = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)


def _order(records: NDArray[Any]) -> NDArray[np.intp] | None:
    """By decision instant, requirement, whether in doubt, and number; the undecided ones last.

    `None`: they stand so already.
    """
    undecided = records["decision"] == _OPEN
    decided = np.where(undecided, np.iinfo(np.int64).max, records["decided"])
    if (decided[1:] > decided[:-1]).all():
        return None
    keys = (records["number"], records["in_doubt"], records["requirement"], decided)
    return np.lexsort(keys)
