"""Rows of any source as samples: in order, equal stamps merged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rvmon.errors import TimeOrderError
from rvmon.readers.alternation import Alternations
from rvmon.readers.coalesce import Conflicts, coalesce, updates_in
from rvmon.readers.steps import LOOKED_AT
from rvmon.trace.health import Health
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Schema
from rvmon.trace.time import format_ticks

Row = tuple[int, int, Mapping[str, Value]]
"""Number, ticks, what it updates."""


class Rows:
    """Makes samples of rows, and notes what is odd about them.

    Args:
        schema: the declared names.
        unit: what a row is called.
        ordered: whether a stamp before the one above it is an error; not so under `max delay`.

    Attributes:
        count: of the rows that were read.
        first: the instants of the first rows, ticks.
        alternations: how known and unknown values follow each other.
    """

    def __init__(self, schema: Schema, unit: str, *, ordered: bool) -> None:
        self._schema = schema
        self._unit = unit
        self._ordered = ordered
        self._conflicts = Conflicts()
        self.count = 0
        self.first: list[int] = []
        self.alternations = Alternations()

    def samples(self, rows: Iterable[Row]) -> Iterator[Sample]:
        """The samples of a source that is read from its start.

        Raises:
            TimeOrderError: a row is before the one above it.
        """
        self._conflicts, self.alternations = Conflicts(), Alternations()
        self.count, self.first = 0, []
        for sample in coalesce(self._in_order(rows), self._schema.events, self._conflicts):
            self.alternations.note(sample.values)
            yield sample

    def _in_order(self, rows: Iterable[Row]) -> Iterator[Sample]:
        last: int | None = None
        for number, t, values in rows:
            if self._ordered and last is not None and t < last:
                raise TimeOrderError(
                    f"{self._unit} {number}: time goes backwards, from {format_ticks(last)} to "
                    f"{format_ticks(t)}: sort the recording by time, or allow for late samples "
                    "with `max delay` in the spec"
                )
            last = t
            self.count += 1
            if len(self.first) < LOOKED_AT:
                self.first.append(t)
            # Before equal stamps are merged: what is no update is no other value, either.
            yield Sample(t, updates_in(values, self._schema.ignoring))

    def conflicts(self) -> list[Health]:
        """The signals that got two values at one stamp."""
        return self._conflicts.health()

    def with_findings(self, health: Sequence[Health]) -> tuple[Health, ...]:
        """What a monitor found about these samples, with what was noted here."""
        return (*self.alternations.remarked(health), *self.conflicts())
