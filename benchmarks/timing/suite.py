"""The workloads of every section."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from benchmarks.timing import timescales
from benchmarks.timing.workload import Workload
from tests.tools.build import always, compared, eventually, no, once, two
from tests.tools.common_fragment import names_in

from rvmon.spec.checked.formula import Formula, SignalAtom, SignalValue

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


def families(rows: int, bounds: Sequence[int] = timescales.BOUNDS) -> Iterator[Workload]:
    """The Timescales families in both forms."""
    for family in timescales.FAMILIES:
        for high in bounds:
            columns = timescales.trace(family, high, rows)
            low = timescales.low_bound(high)
            name = f"{family.name} {high}"
            yield Workload("online", name, "past", (family.past(low, high),), columns)
            yield Workload("online", name, "future", (family.future(low, high),), columns)


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
        yield Workload("many", f"{count} monitors", "past", _responses(count, "past"), columns)
        yield Workload("many", f"{count} monitors", "future", _responses(count, "future"), columns)


def _responses(count: int, form: str) -> tuple[Formula, ...]:
    rng = random.Random("responses")
    formulas = []
    for _ in range(count):
        asked, answer = (SignalAtom(f"v{n}") for n in rng.sample(range(SIGNALS), 2))
        deadline = rng.randint(40, 400)
        if form == "past":
            formulas.append(no(two(no(answer), "S", two(asked, "and", no(answer)), deadline, None)))
        else:
            formulas.append(two(asked, "->", eventually(answer, 0, deadline)))
    return tuple(formulas)


def bounds(
    rows: int, highs: Sequence[int] = (10, 100, 1_000, 10_000, 100_000)
) -> Iterator[Workload]:
    """One response with a growing deadline, on one trace."""
    p, s = SignalAtom("p"), SignalAtom("s")
    rng = random.Random("bounds")
    columns: dict[str, list[bool | float]] = {"p": [False] * rows, "s": [False] * rows}
    row = 0
    while row < rows - 20:
        columns["p"][row] = True
        row += rng.randint(1, 9)
        columns["s"][row] = True
        row += rng.randint(1, 9)
    for high in highs:
        past = no(two(no(s), "S", p, high, None))
        future = two(p, "->", eventually(s, 0, high))
        yield Workload("bound", f"bound {high}", "past", (past,), columns)
        yield Workload("bound", f"bound {high}", "future", (future,), columns)


def unsteady(section: str, rows: int) -> Iterator[Workload]:
    """Forms that people write, over values that are drawn anew and cross at every row."""
    rng = random.Random("unsteady")
    x: list[bool | float] = [rng.uniform(0, 10) for _ in range(rows)]
    stop = [rng.uniform(0, 10 if row % 400 == 0 else 5) for row in range(rows)]
    speed = [rng.uniform(0, 0.01 if row // 230 % 2 else 0.02) for row in range(rows)]
    at_rest = eventually(always(compared(SignalValue("v"), "<=", 0.01), 0, 200), 0, 30)
    for name, formula, columns in (
        ("respond", two(_over(5), "->", eventually(_under(5), 0, 100)), {"x": x}),
        ("soon", eventually(_over(5), 0, 10), {"x": x}),
        ("recur", always(eventually(_over(5), 0, 10), 0, 100), {"x": x}),
        ("settle", two(_over(8), "->", eventually(always(_under(6), 0, 30), 0, 50)), {"x": x}),
        (
            "stop",
            two(compared(SignalValue("s"), ">", 5), "->", at_rest),
            {"s": stop, "v": speed},
        ),
    ):
        yield Workload(section, name, "future", (formula,), columns, 1_000_000_000)


_FAILING = {
    "1 %": {"limit": 9.9, "respond": 6.3, "soon": 6.9, "recur": 8.2, "settle": 8.6, "past": 6.4},
    "30 %": {"limit": 7.0, "respond": 1.2, "soon": 2.6, "recur": 5.2, "settle": 5.1, "past": 1.2},
}
"""Below which a value has to be for the formula to be false at that share of the rows."""


def failing(rows: int) -> Iterator[Workload]:
    """Forms that are false at 1 % and at 30 % of the rows; all values are new at every row."""
    rng = random.Random("failing")
    columns: dict[str, list[bool | float]] = {
        name: [rng.uniform(0, 10) for _ in range(rows)] for name in "xy"
    }
    for share, limits in _FAILING.items():
        for name, limit in limits.items():
            x, y = _under(limit), _under(limit, "y")
            form, formula = {
                "limit": ("past", x),
                "respond": ("future", two(_over(5), "->", eventually(y, 0, 3))),
                "soon": ("future", eventually(x, 0, 3)),
                "recur": ("future", always(eventually(x, 0, 3), 0, 10)),
                "settle": ("future", two(_over(5), "->", eventually(always(y, 0, 3), 0, 10))),
                "past": ("past", two(_over(5), "->", once(y, 0, 3))),
            }[name]
            used = {key: columns[key] for key in sorted(names_in(formula))}
            yield Workload("failing", f"{name}, {share}", form, (formula,), used, 1_000_000_000)


def _over(value: float) -> Formula:
    return compared(SignalValue("x"), ">", value)


def _under(value: float, name: str = "x") -> Formula:
    return compared(SignalValue(name), "<", value)


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
    formula = family.past(timescales.low_bound(high), high)
    return Workload(section, f"{name} {high}, {rows:,} rows", "past", (formula,), columns)
