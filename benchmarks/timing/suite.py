"""The workloads of every section."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

from benchmarks.timing import timescales
from benchmarks.timing.workload import Column, Workload, formula
from tests.tools.common_fragment import names_in

from rvmon.spec.checked.formula import Formula

SIGNALS = 20
"""Of the stream that many monitors read."""

_BATCHED = (
    ("AbsentAQ", 10),
    ("RespondGLB", 10),
    ("AbsentBQR", 100),
    ("RespondGLB", 1000),
    ("AbsentBQR", 1000),
    ("RecurGLB", 1000),
    ("RespondBQR", 1000),
)


FORMS = ("past", "future")


def families(rows: int, bounds: Sequence[int] = timescales.BOUNDS) -> Iterator[Workload]:
    """The Timescales families in both forms."""
    for family in timescales.FAMILIES:
        for high in bounds:
            columns = timescales.trace(family, high, rows)
            for form in FORMS:
                asked = formula(family.text(form, high))
                yield Workload("online", f"{family.name} {high}", form, (asked,), columns)


def many(rows: int, counts: Sequence[int] = (10, 100, 1000)) -> Iterator[Workload]:
    """So many responses on one stream of 20 signals, of which one changes at each row."""
    names = [f"v{number}" for number in range(SIGNALS)]
    rng = random.Random("many")
    columns: dict[str, list[bool | float]] = {name: [] for name in names}
    state = dict.fromkeys(names, False)
    for _ in range(rows):
        changed = names[rng.randrange(SIGNALS)]
        state[changed] = not state[changed]
        for name in names:
            columns[name].append(state[name])
    for count in counts:
        for form in FORMS:
            formulas = tuple(_responses(names, count, form))
            yield Workload("many", f"{count} monitors", form, formulas, columns)


def _responses(names: Sequence[str], count: int, form: str) -> Iterator[Formula]:
    rng = random.Random("responses")
    for _ in range(count):
        asked, answer = rng.sample(names, 2)
        deadline = rng.randint(40, 400)
        if form == "past":
            text = f"not ((not {answer}) since[{deadline} ns, inf) ({asked} and not {answer}))"
        else:
            text = f"{asked} -> eventually[0 ns, {deadline} ns] {answer}"
        yield formula(text, f"{asked}, {answer}")


def bounds(
    rows: int, highs: Sequence[int] = (10, 100, 1_000, 10_000, 100_000)
) -> Iterator[Workload]:
    """One response with a growing deadline, on one trace."""
    rng = random.Random("bounds")
    columns: dict[str, list[bool | float]] = {"p": [False] * rows, "s": [False] * rows}
    row = 0
    while row < rows - 20:
        columns["p"][row] = True
        row += rng.randint(1, 9)
        columns["s"][row] = True
        row += rng.randint(1, 9)
    for high in highs:
        texts = f"not ((not s) since[{high} ns, inf) p)", f"p -> eventually[0 ns, {high} ns] s"
        for form, text in zip(FORMS, texts, strict=True):
            yield Workload("bound", f"bound {high}", form, (formula(text),), columns)


UNSTEADY = {
    "respond": "x > 5 -> eventually[0 ns, 100 ns] x < 5",
    "soon": "eventually[0 ns, 10 ns] x > 5",
    "recur": "always[0 ns, 100 ns] eventually[0 ns, 10 ns] x > 5",
    "settle": "x > 8 -> eventually[0 ns, 50 ns] always[0 ns, 30 ns] x < 6",
    "stop": "s > 5 -> eventually[0 ns, 30 ns] always[0 ns, 200 ns] v <= 0.01",
}
"""Forms that people write."""


def unsteady(section: str, rows: int) -> Iterator[Workload]:
    """Over values that are drawn anew and cross at every row."""
    rng = random.Random("unsteady")
    columns = {
        "x": [rng.uniform(0, 10) for _ in range(rows)],
        "s": [rng.uniform(0, 10 if row % 400 == 0 else 5) for row in range(rows)],
        "v": [rng.uniform(0, 0.01 if row // 230 % 2 else 0.02) for row in range(rows)],
    }
    for name, text in UNSTEADY.items():
        asked = formula(text, "p", "x, s, v")
        yield Workload(section, name, "future", (asked,), _read(asked, columns), 1_000_000_000)


_FAILING = {
    "1 %": {"limit": 9.9, "respond": 6.3, "soon": 6.9, "recur": 8.2, "settle": 8.6, "past": 6.4},
    "30 %": {"limit": 7.0, "respond": 1.2, "soon": 2.6, "recur": 5.2, "settle": 5.1, "past": 1.2},
}
"""Below which a value has to be for the formula to be false at that share of the rows."""

_FORMS = {
    "limit": ("past", "x < {}"),
    "respond": ("future", "x > 5 -> eventually[0 ns, 3 ns] y < {}"),
    "soon": ("future", "eventually[0 ns, 3 ns] x < {}"),
    "recur": ("future", "always[0 ns, 10 ns] eventually[0 ns, 3 ns] x < {}"),
    "settle": ("future", "x > 5 -> eventually[0 ns, 10 ns] always[0 ns, 3 ns] y < {}"),
    "past": ("past", "x > 5 -> once[0 ns, 3 ns] y < {}"),
}


def failing(rows: int) -> Iterator[Workload]:
    """Forms that are false at 1 % and at 30 % of the rows; all values are new at every row."""
    rng = random.Random("failing")
    columns = {name: [rng.uniform(0, 10) for _ in range(rows)] for name in "xy"}
    for share, limits in _FAILING.items():
        for name, limit in limits.items():
            form, text = _FORMS[name]
            asked = formula(text.format(limit), "p", "x, y")
            used = _read(asked, columns)
            yield Workload("failing", f"{name}, {share}", form, (asked,), used, 1_000_000_000)


def _read(asked: Formula, columns: Mapping[str, Column]) -> dict[str, Column]:
    """The columns that a formula reads."""
    return {name: columns[name] for name in sorted(names_in(asked))}


def batches(rows: int) -> Iterator[Workload]:
    """Families for columns in memory: many and few rows that change, and a tenth of the rows."""
    for name, high in _BATCHED:
        yield _family("batch", name, high, rows)
        yield _family("batch", name, high, rows // 10)


def processed(rows: int) -> Iterator[Workload]:
    """Families for whole processes: many and few rows that change."""
    for name, high in (("AbsentAQ", 10), ("RespondGLB", 1000)):
        yield _family("process", name, high, rows)


def _family(section: str, name: str, high: int, rows: int) -> Workload:
    family = next(family for family in timescales.FAMILIES if family.name == name)
    columns = timescales.trace(family, high, rows)
    asked = formula(family.text("past", high))
    return Workload(section, f"{name} {high}, {rows:,} rows", "past", (asked,), columns)
