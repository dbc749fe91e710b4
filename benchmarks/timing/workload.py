"""The workloads: formulas over a trace of rows, by section, and their specifications."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from operator import xor

from benchmarks.timing import timescales

from rvmon import loads
from rvmon.language.checked.formula import Formula
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.rewrite import without_spans

Column = Sequence[bool | float]
FORMS = ("past", "future")
SECOND = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Workload:
    """Formulas that should hold at every row, and the rows."""

    section: str  # the table it belongs to
    name: str  # the line of that table
    form: str  # `past` or `future`: the tense of the formulas
    formulas: tuple[Formula, ...]  # with bounds in rows
    columns: Mapping[str, Column]  # the values of each name, one per row
    period: int = 1  # ticks from row to row

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


@dataclass(frozen=True, slots=True)
class Size:
    """The amount of measuring."""

    rows: int = 50_000  # of traces judged row by row
    # rows judged in memory or by whole processes; a tenth of them is measured as well
    columns: int = 1_000_000
    longest: int = 300_000  # rows of traces for growing deadlines
    bounds: tuple[int, ...] = timescales.BOUNDS  # of the Timescales families
    counts: tuple[int, ...] = (10, 100, 1000)  # of monitors on one stream
    step_seconds: float = 30  # time in which a peer may judge one workload for comparison
    repeats: int = 5  # passes of each contender
    processes: int = 3  # measured runs of each program, after a first one that does not count
    file_rows: int = 10_000_000  # of one large file
    files: int = 1_000  # number of small files
    pass_seconds: float = 0.1  # planned time of a pass; slow contenders get fewer rows


QUICK = Size(5_000, 100_000, 20_000, (10, 1000), (10, 100), 10, 3, 2, 1_000_000, 40, 0.05)


def formula(text: str, bools: str = "p, q, r, s", reals: str = "") -> Formula:
    """Parse a formula of rvmon over Boolean signals and numbers.

    >>> formula("p -> within 3 ns x > 1", reals="x").interval is None
    True
    """
    numbers = f"signal {reals} : real\n" if reals else ""
    declared = f"time sampled\nsignal {bools} : bool\n{numbers}"
    spec = loads(f"{declared}requirement R\n  upon start then ({text})\n")
    return without_spans(spec.checked.requirements["R"].consequent)


def specification(requirements: Sequence[str], columns: Mapping[str, Column]) -> str:
    """A specification in held time with one requirement per text, which follows its name.

    The distance of rows in ticks is the scale of the bounds, so that a value held from row to row
    is what discrete-time tools see at each row.
    """
    lines = ["spec benchmark", "time held", ""]
    for name, column in columns.items():
        lines.append(f"signal {name} : {'bool' if isinstance(column[0], bool) else 'real'}")
    for number, text in enumerate(requirements, start=1):
        lines += ["", f"requirement R{number}", f"  {text}"]
    return "\n".join(lines) + "\n"


def _online(size: Size) -> Iterator[Workload]:
    """The Timescales families in both forms."""
    for family in timescales.FAMILIES.values():
        for high in size.bounds:
            columns = timescales.trace(family, high, size.rows)
            for form in FORMS:
                asked = formula(family.text(form, high))
                yield Workload("online", f"{family.name} {high}", form, (asked,), columns)


def _many(size: Size) -> Iterator[Workload]:
    """Many responses on one stream of 20 signals, of which one changes at each row."""
    names = [f"v{number}" for number in range(20)]
    rng = random.Random("many")
    changed = [rng.choice(names) for _ in range(size.rows // 2)]
    columns = {name: [*accumulate((one == name for one in changed), xor)] for name in names}
    for count in size.counts:
        for form in FORMS:
            rng = random.Random("responses")
            drawn = [(rng.sample(names, 2), rng.randint(40, 400)) for _ in range(count)]
            formulas = tuple(_response(form, a, b, high, strict=True) for (a, b), high in drawn)
            yield Workload("many", f"{count} monitors", form, formulas, columns)


def _response(form: str, asked: str, answer: str, high: int, *, strict: bool = False) -> Formula:
    """A response within a deadline; with `strict` an immediate answer is no request."""
    open_ = f"({asked} and not {answer})" if strict else asked
    past = f"not ((not {answer}) since[{high} ns, inf) {open_})"
    future = f"{asked} -> eventually[0 ns, {high} ns] {answer}"
    return formula(past if form == "past" else future, f"{asked}, {answer}")


def _bound(size: Size) -> Iterator[Workload]:
    """One response with a growing deadline, on one trace."""
    rng, rows = random.Random("bounds"), size.longest
    columns: dict[str, list[bool | float]] = {"p": [False] * rows, "s": [False] * rows}
    row = 0
    while row < rows - 20:
        for name in "ps":
            columns[name][row] = True
            row += rng.randint(1, 9)
    for high in (10, 100, 1_000, 10_000, 100_000):
        for form in FORMS:
            asked = (_response(form, "p", "s", high),)
            yield Workload("bound", f"bound {high}", form, asked, columns)


_UNSTEADY = {
    "respond": "x > 5 -> eventually[0 ns, 100 ns] x < 5",
    "soon": "eventually[0 ns, 10 ns] x > 5",
    "recur": "always[0 ns, 100 ns] eventually[0 ns, 10 ns] x > 5",
    "settle": "x > 8 -> eventually[0 ns, 50 ns] always[0 ns, 30 ns] x < 6",
    "stop": "s > 5 -> eventually[0 ns, 30 ns] always[0 ns, 200 ns] v <= 0.01",
}
"""Formulas as people write them."""


def _unsteady(size: Size, section: str = "unsteady") -> Iterator[Workload]:
    """Formulas over random values that change and cross the bounds at every row."""
    rng, rows = random.Random("unsteady"), size.rows
    columns = {
        "x": [rng.uniform(0, 10) for _ in range(rows)],
        "s": [rng.uniform(0, 10 if row % 400 == 0 else 5) for row in range(rows)],
        "v": [rng.uniform(0, 0.01 if row // 230 % 2 else 0.02) for row in range(rows)],
    }
    for name, text in _UNSTEADY.items():
        yield _of_numbers(section, name, "future", text, columns)


def _of_numbers(
    section: str, name: str, form: str, text: str, columns: Mapping[str, Column]
) -> Workload:
    """A workload with the columns that the formula reads, with rows a second apart."""
    asked = formula(text, "p", ", ".join(columns))
    used = {name: columns[name] for name in sorted({*names_read(asked)})}
    return Workload(section, name, form, (asked,), used, SECOND)


_FAILING = {
    "limit": ("past", "x < {}", 9.9, 7.0),
    "respond": ("future", "x > 5 -> eventually[0 ns, 3 ns] y < {}", 6.3, 1.2),
    "soon": ("future", "eventually[0 ns, 3 ns] x < {}", 6.9, 2.6),
    "recur": ("future", "always[0 ns, 10 ns] eventually[0 ns, 3 ns] x < {}", 8.2, 5.2),
    "settle": ("future", "x > 5 -> eventually[0 ns, 10 ns] always[0 ns, 3 ns] y < {}", 8.6, 5.1),
    "past": ("past", "x > 5 -> once[0 ns, 3 ns] y < {}", 6.4, 1.2),
}
"""Form, formula, and the numbers that make it false at 1 % and at 30 % of the rows."""


def _failing(size: Size) -> Iterator[Workload]:
    """Formulas that are false at 1 % and at 30 % of the rows; all values change at every row."""
    rng = random.Random("failing")
    columns = {name: [rng.uniform(0, 10) for _ in range(size.rows)] for name in "xy"}
    for place, share in enumerate(("1 %", "30 %")):
        for name, (form, text, *limits) in _FAILING.items():
            asked = text.format(limits[place])
            yield _of_numbers("failing", f"{name}, {share}", form, asked, columns)


_BATCHED = (
    *(("AbsentAQ", 10), ("RespondGLB", 10), ("AbsentBQR", 100), ("RespondGLB", 1000)),
    *(("AbsentBQR", 1000), ("RecurGLB", 1000), ("RespondBQR", 1000)),
)


def families(section: str, named: Sequence[tuple[str, int]], *rows: int) -> Iterator[Workload]:
    """Past forms of Timescales families, on traces of the given numbers of rows."""
    for name, high in named:
        family = timescales.FAMILIES[name]
        asked = (formula(family.text("past", high)),)
        for count in rows:
            columns = timescales.trace(family, high, count)
            yield Workload(section, f"{name} {high}, {count:,} rows", "past", asked, columns)


SECTIONS: Mapping[str, Callable[[Size], Iterator[Workload]]] = {
    "online": _online,
    "many": _many,
    "bound": _bound,
    "unsteady": _unsteady,
    "failing": _failing,
    "margins": lambda size: _unsteady(size, "margins"),
    "batch": lambda size: families("batch", _BATCHED, size.columns, size.columns // 10),
}
"""The workloads of each section."""
