"""What is measured: formulas over a trace of rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.spec.checked.formula import Formula

Column = Sequence[bool | float]


@dataclass(frozen=True, slots=True)
class Workload:
    """Formulas to hold at every row, and the rows.

    Attributes:
        section: the table it belongs to.
        name: the line of that table.
        form: `past` or `future`: what the formulas speak of.
        formulas: with bounds in rows.
        columns: by name the value at each row.
        period: ticks from row to row.
    """

    section: str
    name: str
    form: str
    formulas: tuple[Formula, ...]
    columns: Mapping[str, Column]
    period: int = 1

    @property
    def rows(self) -> int:
        """The length of the trace."""
        return len(next(iter(self.columns.values())))

    @property
    def changing(self) -> float:
        """The share of rows at which some column changes."""
        columns = list(self.columns.values())
        changed = sum(
            any(column[row] != column[row - 1] for column in columns) for row in range(1, self.rows)
        )
        return changed / max(self.rows - 1, 1)
