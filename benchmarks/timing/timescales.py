"""The Timescales families: bounded absence, universality, recurrence and response in scopes.

Ten properties, each in a past and a future form with a scalable bound, and traces on which they
hold at every row until a violation near the end. The generator is our own, based on the published
definitions (`timescales.toml`). Times are rows, one tick apart. Universality is the absence of the
negation, on negated traces.

Source: D. Ulus, Timescales: a benchmark generator for MTL monitoring tools, RV 2019; properties and
traces of its public suite. There the deadline of the past response is `not s since[:b] p`, which no
trace with a `p` fulfils; here it is `since[b:]`, as the future form demands.
"""

from __future__ import annotations

import random
import re
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import structs

BOUNDS = (10, 100, 1000)

Rows = Sequence[str | list[str]]
"""Rows in the notation of `timescales.toml`."""

_WORDS = {
    "BETWEEN": "(r and not q and once q)",  # the scope between q and r has just ended
    "OPENS": "(q and not r and eventually r)",  # it opens, if it ever closes
    "ANSWERED": "((s -> once[LOW, HIGH] p) and not ((not s) since[HIGH, inf) p))",
}


class Family(msgspec.Struct, frozen=True):
    """One property with its traces; see `timescales.toml`."""

    name: str  # property and scope
    names: str
    past: str
    future: str
    episode: Rows
    violation: Rows
    is_contrary: bool = False  # whether p is negated in traces

    def text(self, form: str, high: int) -> str:
        """The formula of a form, `past` or `future`, for an upper bound."""
        found: str = getattr(self, form)
        bounds = {"LOW": f"{_low_bound(high)} ns", "HIGH": f"{high} ns"}
        for word, meaning in {**_WORDS, **bounds}.items():
            found = found.replace(word, meaning)
        return found


def _low_bound(high: int) -> int:
    return 3 * high // 10


def _parts(rng: random.Random, rows: Rows, high: int) -> Iterator[tuple[str, int]]:
    """The true columns, and the number of rows for which they are true."""
    known = {"low": _low_bound(high), "high": high}
    known |= {f"high{more:+d}": high + more for more in (-2, -1, 1)}

    def number(text: str) -> int:
        return known[text] if text in known else int(text)

    for row in rows:
        if not isinstance(row, str):
            for _ in range(rng.randint(1, 7)):
                yield from _parts(rng, row, high)
            continue
        true, _, count = row.partition(" ")
        least, _, most = count.partition("..")
        yield true.strip("-"), rng.randint(number(least), number(most)) if most else number(least)


def trace(family: Family, high: int, rows: int, seed: int = 1) -> dict[str, list[bool]]:
    """A trace of about `rows` rows that satisfies the past form at every row but the last."""
    rng = random.Random(f"{family.name}/{high}/{seed}")
    columns: dict[str, list[bool]] = {name: [] for name in family.names}

    def add(told: Rows) -> None:
        for true, count in _parts(rng, told, high):
            for name, column in columns.items():
                if true == f"?{name}":
                    column.extend(rng.random() < 0.5 for _ in range(count))
                else:
                    is_true = (name in true) is not (family.is_contrary and name == "p")
                    column.extend([is_true and true[:1] != "?"] * count)

    while len(columns[family.names[0]]) < rows - 2 * high:
        add(family.episode)
    add(family.violation)
    return columns


def _families() -> Iterator[Family]:
    text = Path(__file__).with_suffix(".toml").read_text("utf-8")
    for family in msgspec.convert(tomllib.loads(text)["family"], list[Family]):
        yield family
        if family.name.startswith("Absent"):
            past, future = (
                re.sub(r"\(not p\)|not p", "p", one) for one in (family.past, family.future)
            )
            name = family.name.replace("Absent", "Always")
            yield structs.replace(family, name=name, past=past, future=future, is_contrary=True)


FAMILIES = {family.name: family for family in _families()}
