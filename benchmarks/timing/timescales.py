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
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tests.tools.build import always, eventually, historically, no, once, two

from rvmon.spec.checked.formula import Formula, SignalAtom

BOUNDS = (10, 100, 1000)

_p, _q, _r, _s = (SignalAtom(name) for name in "pqrs")


Part = tuple[str, int]
"""Names that are true, and at how many rows; behind `?` a name that is drawn at each."""


@dataclass(frozen=True, slots=True)
class Family:
    """One property with its traces.

    Attributes:
        name: property and scope.
        names: the columns.
        past: the past form for the bounds low and high, to hold at every row.
        future: the future form, likewise.
        episode: rows on which both forms hold, for the bounds low and high.
        violation: rows on which the past form is false at the last of them.
    """

    name: str
    names: str
    past: Callable[[int, int], Formula]
    future: Callable[[int, int], Formula]
    episode: Callable[[random.Random, int, int], Sequence[Part]]
    violation: Callable[[int, int], Sequence[Part]]


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
    columns: dict[str, list[bool]] = {name: [] for name in family.names}

    def add(parts: Sequence[Part]) -> None:
        for true, count in parts:
            for name, column in columns.items():
                if true == f"?{name}":
                    column.extend(rng.random() < 0.5 for _ in range(count))
                else:
                    column.extend([name in true] * count)

    while len(columns[family.names[0]]) < rows - 2 * high:
        add(family.episode(rng, low, high))
    add(family.violation(low, high))
    return columns


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


def _in_scope(true: str) -> Callable[[random.Random, int, int], Sequence[Part]]:
    """A scope between q and r within which a name is always true, or none is."""
    noise = "?p" if not true else ""
    return lambda rng, low, high: [
        (f"q{true}", 1),
        (true, rng.randint(low, high - 1)),
        (f"{true}r", 1),
        (noise, 1),
    ]


def _recurring(rng: random.Random, high: int) -> Part:
    return "", rng.randint(1, high) - 1


def _recurring_between(rng: random.Random, _: int, high: int) -> Sequence[Part]:
    again = [part for _ in range(rng.randint(1, 7)) for part in (_recurring(rng, high), ("p", 1))]
    return [("q", 1), *again, _recurring(rng, high), ("r", 1), _recurring(rng, high)]


def _responding(rng: random.Random, low: int, high: int) -> list[Part]:
    return [("p", 1), ("", rng.randint(low + 1, high) - 1), ("s", 1)]


def _responding_between(rng: random.Random, low: int, high: int) -> Sequence[Part]:
    several = range(rng.randint(1, 7))
    again = [part for _ in several for part in (*_responding(rng, low, high), ("", 1))]
    return [("q", 1), ("", 1), *again, ("r", 1)]


FAMILIES = (
    Family(
        "AbsentAQ",
        "qp",
        _after(no(_p)),
        lambda _, high: two(_q, "->", always(no(_p), 0, high)),
        lambda _rng, _, high: [("q", 1), ("", high), ("?p", high)],
        lambda _, high: [("q", 1), ("", high - 1), ("p", 1)],
    ),
    Family(
        "AbsentBR",
        "pr",
        _before(no(_p)),
        _before_future(no(_p)),
        lambda _rng, _, high: [("?p", high), ("", high), ("r", 1)],
        lambda _, high: [("p", 1), ("", high - 1), ("r", 1)],
    ),
    Family(
        "AbsentBQR",
        "qpr",
        _between_past(no(_p)),
        _between_future(no(_p)),
        _in_scope(""),
        lambda _, high: [("q", 1), ("", high - 2), ("p", 1), ("r", 1)],
    ),
    Family(
        "AlwaysAQ",
        "qp",
        _after(_p),
        lambda _, high: two(_q, "->", always(_p, 0, high)),
        lambda _rng, _, high: [("qp", 1), ("p", high), ("?p", high)],
        lambda _, high: [("qp", 1), ("p", high - 1), ("", 1)],
    ),
    Family(
        "AlwaysBR",
        "pr",
        _before(_p),
        _before_future(_p),
        lambda _rng, _, high: [("?p", high), ("p", high), ("pr", 1)],
        lambda _, high: [("", 1), ("p", high - 1), ("pr", 1)],
    ),
    Family(
        "AlwaysBQR",
        "qpr",
        _between_past(_p),
        _between_future(_p),
        _in_scope("p"),
        lambda _, high: [("qp", 1), ("p", high + 1), ("pr", 1)],
    ),
    Family(
        "RecurGLB",
        "p",
        lambda _, high: once(_p, 0, high),
        lambda _, high: eventually(_p, 0, high),
        lambda rng, _, high: [("p", 1), _recurring(rng, high)],
        lambda _, high: [("p", 1), ("", high + 1)],
    ),
    Family(
        "RecurBQR",
        "qpr",
        lambda _, high: two(_between(), "->", two(once(two(_p, "or", _q), 0, high), "S", _q)),
        lambda _, high: two(_opens(), "->", two(once(two(_p, "or", _q), 0, high), "U", _r)),
        _recurring_between,
        lambda _, high: [("q", 1), ("", high + 1), ("r", 1)],
    ),
    Family(
        "RespondGLB",
        "ps",
        _answered,
        lambda low, high: two(_p, "->", eventually(_s, low, high)),
        _responding,
        lambda _, high: [("p", 1), ("", high)],
    ),
    Family(
        "RespondBQR",
        "qpsr",
        lambda low, high: two(_between(), "->", two(_answered(low, high), "S", _q)),
        lambda low, high: two(_opens(), "->", two(_p, "->", eventually(_s, low, high))),
        _responding_between,
        lambda _, high: [("q", 1), ("p", 1), ("", high + 1), ("r", 1)],
    ),
)
