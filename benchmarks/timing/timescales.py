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
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

BOUNDS = (10, 100, 1000)

Part = tuple[str, int]
"""Names that are true, and at how many rows; behind `?` a name that is drawn at each."""

_WORDS = {
    "BETWEEN": "(r and not q and once q)",  # the scope between q and r has just ended
    "OPENS": "(q and not r and eventually r)",  # it opens, if it ever closes
    "ANSWERED": "((s -> once[LOW, HIGH] p) and not ((not s) since[HIGH, inf) p))",
}


@dataclass(frozen=True, slots=True)
class Family:
    """One property with its traces."""

    name: str  # property and scope
    names: str  # the columns
    past: str  # the past form, to hold at every row; with `LOW` and `HIGH` bounds
    future: str  # the future form, likewise
    # rows on which both forms hold, for the bounds low and high
    episode: Callable[[random.Random, int, int], Sequence[Part]]
    # rows on which the past form is false at the last of them
    violation: Callable[[int], Sequence[Part]]

    def text(self, form: str, high: int) -> str:
        """The form that is named, for an upper bound."""
        found: str = getattr(self, form)
        bounds = {"LOW": f"{_low_bound(high)} ns", "HIGH": f"{high} ns"}
        for word, meaning in {**_WORDS, **bounds}.items():
            found = found.replace(word, meaning)
        return found


def _low_bound(high: int) -> int:
    return 3 * high // 10


def trace(family: Family, high: int, rows: int, seed: int = 1) -> dict[str, list[bool]]:
    """A trace that fulfils the past form at every row but the last.

    Args:
        family: the property.
        high: the upper bound, rows; the lower one is three tenths of it.
        rows: the least length; the last episode is made whole.
        seed: of the random choices.
    """
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
        add(family.episode(rng, _low_bound(high), high))
    add(family.violation(high))
    return columns


def _quiet(rng: random.Random, high: int) -> Part:
    return "", rng.randint(1, high) - 1


def _recurring(rng: random.Random, _: int, high: int) -> Sequence[Part]:
    again = [part for _ in range(rng.randint(1, 7)) for part in (_quiet(rng, high), ("p", 1))]
    return [("q", 1), *again, _quiet(rng, high), ("r", 1), _quiet(rng, high)]


def _answered(rng: random.Random, low: int, high: int) -> list[Part]:
    return [("p", 1), ("", rng.randint(low + 1, high) - 1), ("s", 1)]


def _responding(rng: random.Random, low: int, high: int) -> Sequence[Part]:
    several = range(rng.randint(1, 7))
    again = [part for _ in several for part in (*_answered(rng, low, high), ("", 1))]
    return [("q", 1), ("", 1), *again, ("r", 1)]


_ABSENT = (
    Family(
        "AbsentAQ",
        "qp",
        "(once[0 ns, HIGH] q) -> (not p) since q",
        "q -> always[0 ns, HIGH] not p",
        lambda _rng, _, high: [("q", 1), ("", high), ("?p", high)],
        lambda high: [("q", 1), ("", high - 1), ("p", 1)],
    ),
    Family(
        "AbsentBR",
        "pr",
        "r -> historically[0 ns, HIGH] not p",
        "(eventually[0 ns, HIGH] r) -> (not p) until r",
        lambda _rng, _, high: [("?p", high), ("", high), ("r", 1)],
        lambda high: [("p", 1), ("", high - 1), ("r", 1)],
    ),
    Family(
        "AbsentBQR",
        "qpr",
        "BETWEEN -> (not p) since[LOW, HIGH] q",
        "OPENS -> (not p) until[LOW, HIGH] r",
        lambda rng, low, high: [("q", 1), ("", rng.randint(low, high - 1)), ("r", 1), ("?p", 1)],
        lambda high: [("q", 1), ("", high - 2), ("p", 1), ("r", 1)],
    ),
)


def _always(family: Family) -> Family:
    """Universality: absence of the contrary, on traces with the contrary."""

    def other(parts: Sequence[Part]) -> Sequence[Part]:
        return [
            (true if "?" in true else true.replace("p", "") if "p" in true else f"{true}p", count)
            for true, count in parts
        ]

    past, future = (re.sub(r"\(not p\)|not p", "p", one) for one in (family.past, family.future))
    return Family(
        family.name.replace("Absent", "Always"),
        family.names,
        past,
        future,
        lambda rng, low, high: other(family.episode(rng, low, high)),
        lambda high: other(family.violation(high)),
    )


def _families() -> Iterator[Family]:
    yield from _ABSENT
    yield from map(_always, _ABSENT)
    yield Family(
        "RecurGLB",
        "p",
        "once[0 ns, HIGH] p",
        "eventually[0 ns, HIGH] p",
        lambda rng, _, high: [("p", 1), _quiet(rng, high)],
        lambda high: [("p", 1), ("", high + 1)],
    )
    yield Family(
        "RecurBQR",
        "qpr",
        "BETWEEN -> (once[0 ns, HIGH] (p or q)) since q",
        "OPENS -> (once[0 ns, HIGH] (p or q)) until r",
        _recurring,
        lambda high: [("q", 1), ("", high + 1), ("r", 1)],
    )
    yield Family(
        "RespondGLB",
        "ps",
        "ANSWERED",
        "p -> eventually[LOW, HIGH] s",
        _answered,
        lambda high: [("p", 1), ("", high)],
    )
    yield Family(
        "RespondBQR",
        "qpsr",
        "BETWEEN -> ANSWERED since q",
        "OPENS -> (p -> eventually[LOW, HIGH] s)",
        _responding,
        lambda high: [("q", 1), ("p", 1), ("", high + 1), ("r", 1)],
    )


FAMILIES = tuple(_families())
