"""Reports of compiled monitors: their records become attempts when someone looks at them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rvmon.codegen.c_batch import RunRecords
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_tables import DECISIONS, VERDICTS
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.attempt_json import Pattern, attempt_text, numbers_texts
from rvmon.verdict.instants import seconds_of
from rvmon.verdict.lazy import LazyAttempts
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

if TYPE_CHECKING:
    from numpy.typing import NDArray

_OPEN = DECISIONS.index(Decision.OPEN)


class RecordedAttempts(LazyAttempts):
    """Attempts without reasons, made from the records of a compiled monitor.

    Args:
        ids: of the requirements, by number.
        records: array of `rvmon.codegen.c_batch.record_type`, in the order of reports.
        captured: reads the values in them.
    """

    def __init__(self, ids: Sequence[str], records: NDArray[Any], captured: CapturedValues) -> None:
        self._ids = tuple(ids)
        self._records = records
        self._captured = captured

    def __len__(self) -> int:
        return len(self._records)

    @overload
    def __getitem__(self, index: int) -> Attempt: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Attempt]: ...
    def __getitem__(self, index: int | slice) -> Attempt | Sequence[Attempt]:
        if isinstance(index, slice):
            return RecordedAttempts(self._ids, self._records[index], self._captured)
        return self._attempt(*self._records[index].tolist())

    def __iter__(self) -> Iterator[Attempt]:
        return (self._attempt(*record) for record in self._records.tolist())

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """See `LazyAttempts`."""
        records = self._records
        own = records["requirement"] == self._ids.index(requirement)
        chosen = np.flatnonzero(own & (records["verdict"] == VERDICTS.index(verdict)))
        return (self[index] for index in chosen.tolist())

    def texts(self, origin: int) -> Iterator[tuple[str, str]]:
        """See `LazyAttempts`."""
        if self._captured.count:
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

    def _attempt(
        self,
        requirement: int,
        number: int,
        triggered: int,
        decided: int,
        verdict: int,
        decision: int,
        in_doubt: int,
        captured: Sequence[float] = (),
    ) -> Attempt:
        return Attempt(
            self._ids[requirement],
            number,
            triggered,
            None if decision == _OPEN else decided,
            VERDICTS[verdict],
            DECISIONS[decision],
            captured=self._captured.of(requirement, captured),
            in_doubt=bool(in_doubt),
        )


def report_of_records(
    ids: Sequence[str], made: RunRecords, captured: CapturedValues, *, origin: int
) -> Report:
    """Sort and fold records, as `rvmon.verdict.report.report_of` does attempts.

    Args:
        ids: of all requirements that were judged, by number.
        made: by a compiled monitor.
        captured: reads the values in its records.
        origin: the instant from which people count seconds, ticks.

    Source: SEMANTICS, section 3.
    """
    counts = {
        name: {verdict: int(own[VERDICTS.index(verdict)]) for verdict in _COUNTED}
        for name, own in zip(ids, made.counts, strict=True)
    }
    return Report(
        verdicts={
            name: fold(
                [verdict for verdict, count in own.items() if count],
                complete=bool(was_determined),
            )
            for (name, own), was_determined in zip(counts.items(), made.counts[:, 3], strict=True)
        },
        attempts=RecordedAttempts(
            ids, made.records if made.ordered else _ordered(made.records), captured
        ),
        counts=counts,
        origin=origin,
        end=made.end,
    )


_COUNTED = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)


def _ordered(records: NDArray[Any]) -> NDArray[Any]:
    """By decision instant, requirement, whether in doubt, and number; the undecided ones last."""
    undecided = records["decision"] == _OPEN
    decided = np.where(undecided, np.iinfo(np.int64).max, records["decided"])
    keys = (records["number"], records["in_doubt"], records["requirement"], decided)
    order = np.lexsort(keys)
    return records[order]
