"""What is measured: formulas over a trace of rows; and how a user would write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon import loads
from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.rewrite import without_spans
from rvmon.spec.print import format_formula

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
        return len(next(iter(self.columns.values())))

    @property
    def changing(self) -> float:
        """The share of rows at which some column changes."""
        columns = list(self.columns.values())
        changed = sum(
            any(column[row] != column[row - 1] for column in columns) for row in range(1, self.rows)
        )
        return changed / max(self.rows - 1, 1)


def formula(text: str, bools: str = "p, q, r, s", reals: str = "") -> Formula:
    """A formula of our language over Boolean signals, and numbers.

    >>> formula("p -> within 3 ns x > 1", reals="x").interval is None
    True
    """
    numbers = f"signal {reals} : real\n" if reals else ""
    declared = f"time sampled\nsignal {bools} : bool\n{numbers}"
    spec = loads(f"{declared}requirement R\n  upon start then ({text})\n")
    return without_spans(spec.checked.requirements["R"].consequent)


def specification(requirements: Sequence[str], columns: Mapping[str, Column]) -> str:
    """A specification with one requirement per text, in held time.

    The rows are as many ticks apart as the bounds are scaled by, so that a value held from row to
    row is what discrete-time tools see at each row.

    Args:
        requirements: what stands below `requirement R1`, `R2`, …
        columns: the signals, Boolean or numbers.
    """
    lines = ["spec benchmark", "time held", ""]
    for name, column in columns.items():
        lines.append(f"signal {name} : {'bool' if isinstance(column[0], bool) else 'real'}")
    for number, text in enumerate(requirements, start=1):
        lines += ["", f"requirement R{number}", f"  {text}"]
    return "\n".join(lines) + "\n"


def always_text(formula: Formula) -> str:
    """That a formula holds at every position, as people write it.

    >>> from tests.tools.build import eventually, p, q, two
    >>> always_text(two(p, "->", eventually(q, 0, 3)))
    'always (p -> within 3 ns q)'
    """
    return f"always ({format_formula(formula)})"
