"""The Timescales families: bounded absence, universality, recurrence and response in scopes.

Ten properties, each in a past and a future form with a bound that scales, and traces on which they
hold at every row until a violation near the end. The generator is our own, made from the published
definitions; times are rows, one tick apart.

Source: D. Ulus, Timescales: a benchmark generator for MTL monitoring tools, RV 2019; properties and
traces of its public suite. There the deadline of the past response is `not s since[:b] p`, which no
trace with a `p` fulfils; here it is `since[b:]`, as the future form demands.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass

from tests.tools.build import always, eventually, historically, no, once, two

from rvmon.spec.checked.formula import Formula, SignalAtom

BOUNDS = (10, 100, 1000)

_p, _q, _r, _s = (SignalAtom(name) for name in "pqrs")


class Rows:
    """A trace under construction.

    Args:
        names: of the Boolean columns.
    """

    def __init__(self, names: str) -> None:
        self.columns: dict[str, list[bool]] = {name: [] for name in names}

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def add(self, true: str = "", count: int = 1) -> None:
        """So many rows at which exactly these names are true."""
        for name, column in self.columns.items():
            column.extend([name in true] * count)

    def add_noise(self, rng: random.Random, noisy: str, count: int) -> None:
        """So many rows at which one name is drawn and the others are false."""
        for name, column in self.columns.items():
            if name == noisy:
                column.extend(rng.random() < 0.5 for _ in range(count))
            else:
                column.extend([False] * count)


@dataclass(frozen=True, slots=True)
class Family:
    """One property with its traces.

    Attributes:
        name: property and scope.
        names: the columns.
        past: the past form for the bounds low and high, to hold at every row.
        future: the future form, likewise.
        episode: adds rows on which both forms hold.
        violation: adds rows on which the past form is false at the last of them.
    """

    name: str
    names: str
    past: Callable[[int, int], Formula]
    future: Callable[[int, int], Formula]
    episode: Callable[[Rows, random.Random, int, int], None]
    violation: Callable[[Rows, int, int], None]


def low_bound(high: int) -> int:
    """The lower bound that goes with an upper one."""
    return 3 * high // 10


def trace(family: Family, high: int, rows: int, seed: int = 1) -> dict[str, list[bool]]:
    """A trace that fulfils the past form at every row but the last.

    Args:
        family: which property.
        high: the upper bound, rows; the lower one is three tenths of it.
        rows: the least length; the last episode is made whole.
        seed: of the random choices.
    """
    low = low_bound(high)
    rng = random.Random(f"{family.name}/{high}/{seed}")
    made = Rows(family.names)
    while len(made) < rows - 2 * high:
        family.episode(made, rng, low, high)
    family.violation(made, low, high)
    return made.columns


def _between() -> Formula:
    """Where the scope between q and r has just ended."""
    return two(two(_r, "and", no(_q)), "and", once(_q))


def _opens() -> Formula:
    """Where the scope between q and r opens, if it ever closes."""
    return two(two(_q, "and", no(_r)), "and", eventually(_r))


def _after(inside: Formula) -> Callable[[int, int], Formula]:
    return lambda _, high: two(once(_q, 0, high), "->", two(inside, "S", _q))


def _before(inside: Formula) -> Callable[[int, int], Formula]:
    return lambda _, high: two(_r, "->", historically(inside, 0, high))


def _before_future(inside: Formula) -> Callable[[int, int], Formula]:
    return lambda _, high: two(eventually(_r, 0, high), "->", two(inside, "U", _r))


def _between_past(inside: Formula) -> Callable[[int, int], Formula]:
    return lambda low, high: two(_between(), "->", two(inside, "S", _q, low, high))


def _between_future(inside: Formula) -> Callable[[int, int], Formula]:
    return lambda low, high: two(_opens(), "->", two(inside, "U", _r, low, high))


def _answered(low: int, high: int) -> Formula:
    in_time = two(_s, "->", once(_p, low, high))
    return two(in_time, "and", no(two(no(_s), "S", _p, high, None)))


def _absent_after(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add("q")
    rows.add(count=high)
    rows.add_noise(rng, "p", high)


def _absent_after_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("q")
    rows.add(count=high - 1)
    rows.add("p")


def _absent_before(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add_noise(rng, "p", high)
    rows.add(count=high)
    rows.add("r")


def _absent_before_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("p")
    rows.add(count=high - 1)
    rows.add("r")


def _absent_between(rows: Rows, rng: random.Random, low: int, high: int) -> None:
    rows.add("q")
    rows.add(count=rng.randint(low, high - 1))
    rows.add("r")
    rows.add_noise(rng, "p", 1)


def _absent_between_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("q")
    rows.add(count=high - 2)
    rows.add("p")
    rows.add("r")


def _always_after(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add("qp")
    rows.add("p", high)
    rows.add_noise(rng, "p", high)


def _always_after_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("qp")
    rows.add("p", high - 1)
    rows.add()


def _always_before(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add_noise(rng, "p", high)
    rows.add("p", high)
    rows.add("pr")


def _always_before_violated(rows: Rows, _: int, high: int) -> None:
    rows.add()
    rows.add("p", high - 1)
    rows.add("pr")


def _always_between(rows: Rows, rng: random.Random, low: int, high: int) -> None:
    rows.add("qp")
    rows.add("p", rng.randint(low, high - 1))
    rows.add("pr")
    rows.add()


def _always_between_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("qp")
    rows.add("p", high + 1)
    rows.add("pr")


def _recurring(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add("p")
    rows.add(count=rng.randint(1, high) - 1)


def _recurring_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("p")
    rows.add(count=high + 1)


def _recurring_between(rows: Rows, rng: random.Random, _: int, high: int) -> None:
    rows.add("q")
    for _repeat in range(rng.randint(1, 7)):
        rows.add(count=rng.randint(1, high) - 1)
        rows.add("p")
    rows.add(count=rng.randint(1, high) - 1)
    rows.add("r")
    rows.add(count=rng.randint(1, high) - 1)


def _recurring_between_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("q")
    rows.add(count=high + 1)
    rows.add("r")


def _responding(rows: Rows, rng: random.Random, low: int, high: int) -> None:
    rows.add("p")
    rows.add(count=rng.randint(low + 1, high) - 1)
    rows.add("s")


def _responding_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("p")
    rows.add(count=high)


def _responding_between(rows: Rows, rng: random.Random, low: int, high: int) -> None:
    rows.add("q")
    rows.add()
    for _repeat in range(rng.randint(1, 7)):
        _responding(rows, rng, low, high)
        rows.add()
    rows.add("r")


def _responding_between_violated(rows: Rows, _: int, high: int) -> None:
    rows.add("q")
    rows.add("p")
    rows.add(count=high + 1)
    rows.add("r")


FAMILIES = (
    Family(
        "AbsentAQ",
        "qp",
        _after(no(_p)),
        lambda _, high: two(_q, "->", always(no(_p), 0, high)),
        _absent_after,
        _absent_after_violated,
    ),
    Family(
        "AbsentBR",
        "pr",
        _before(no(_p)),
        _before_future(no(_p)),
        _absent_before,
        _absent_before_violated,
    ),
    Family(
        "AbsentBQR",
        "qpr",
        _between_past(no(_p)),
        _between_future(no(_p)),
        _absent_between,
        _absent_between_violated,
    ),
    Family(
        "AlwaysAQ",
        "qp",
        _after(_p),
        lambda _, high: two(_q, "->", always(_p, 0, high)),
        _always_after,
        _always_after_violated,
    ),
    Family(
        "AlwaysBR",
        "pr",
        _before(_p),
        _before_future(_p),
        _always_before,
        _always_before_violated,
    ),
    Family(
        "AlwaysBQR",
        "qpr",
        _between_past(_p),
        _between_future(_p),
        _always_between,
        _always_between_violated,
    ),
    Family(
        "RecurGLB",
        "p",
        lambda _, high: once(_p, 0, high),
        lambda _, high: eventually(_p, 0, high),
        _recurring,
        _recurring_violated,
    ),
    Family(
        "RecurBQR",
        "qpr",
        lambda _, high: two(_between(), "->", two(once(two(_p, "or", _q), 0, high), "S", _q)),
        lambda _, high: two(_opens(), "->", two(once(two(_p, "or", _q), 0, high), "U", _r)),
        _recurring_between,
        _recurring_between_violated,
    ),
    Family(
        "RespondGLB",
        "ps",
        _answered,
        lambda low, high: two(_p, "->", eventually(_s, low, high)),
        _responding,
        _responding_violated,
    ),
    Family(
        "RespondBQR",
        "qpsr",
        lambda low, high: two(_between(), "->", two(_answered(low, high), "S", _q)),
        lambda low, high: two(_opens(), "->", two(_p, "->", eventually(_s, low, high))),
        _responding_between,
        _responding_between_violated,
    ),
)
