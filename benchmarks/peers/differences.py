"""Where peers and the law differ, each with a trace that shows it.

Every row is run on both sides; a peer that answers otherwise than written here has changed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import spelling
from benchmarks.peers.environment import Environment
from benchmarks.peers.ways import Cell, Question, answers, ask_oracle
from benchmarks.program import table

from rvmon import loads

TABLE = Path(__file__).with_name("differences.toml")


@dataclass(frozen=True, slots=True)
class Difference:
    """One point in which a peer reads a formula or a trace otherwise."""

    # its package, the class that asks it, and what that is told of time and semantics
    peer: tuple[str, str, str]
    reading: str  # the peer's, in words
    formula: str  # in the peer's language
    # the peer's answer per tick, of a robustness the sign; or how its error begins
    theirs: list[Cell] | str
    # what looks like the same formula here, on the same trace, in one of our time models
    same: Question


def _read() -> Iterator[Difference]:
    for one in tomllib.loads(TABLE.read_text(encoding="utf-8"))["difference"]:
        spec = loads(
            f"time {one['time']}\nsignal p, q : bool\nsignal x : real\n"
            f"requirement R\n  upon start then {one['same']}\n"
        ).checked
        columns = {name: _known(cells) for name, cells in one["trace"].items()}
        same = Question(spec.requirements["R"].consequent, columns, spec.time)
        said = one["answer"] if isinstance(one["answer"], str) else _known(one["answer"])
        yield Difference(tuple(one["peer"]), one["reading"], one["formula"], said, same)


def _known(cells: Sequence[Cell | str]) -> list[Cell]:
    return [None if isinstance(cell, str) else cell for cell in cells]


DIFFERENCES = tuple(_read())


def answer(difference: Difference, environment: Environment) -> list[Cell] | str:
    _, adapter, kind = difference.peer
    columns = {spelling(name): list(one) for name, one in difference.same.columns.items()}
    with Peer(environment.python, adapter) as peer:
        try:
            found = peer.ask("judge", formula=difference.formula, kind=kind, columns=columns)
        except PeerError as error:
            return str(error)
    values = found["values"]
    if "robustness" in kind or adapter == "Rtamt":
        return [None if not value or value != value else value > 0 for value in values]
    return [None if value is None else bool(value) for value in values]


def lines(environment: Environment) -> Iterator[str]:
    """The differences as a table; peers that are missing are left out."""
    head = ("peer", "reading", "its formula", "trace", "it says", "the law")
    return table(head, _rows(environment))


def _rows(environment: Environment) -> Iterator[Sequence[str]]:
    for one in DIFFERENCES:
        package, _, kind = one.peer
        if package not in environment.versions:
            continue
        found, wanted = answer(one, environment), one.theirs
        if found != wanted and not (
            isinstance(found, str) and isinstance(wanted, str) and found.startswith(wanted)
        ):
            raise AssertionError(f"{package} has changed: {one}: {found}")
        trace = "; ".join(f"{name} {_cells(c)}" for name, c in one.same.columns.items())
        said = found if isinstance(found, str) else _cells(found)
        law = _cells(answers(one.same, ask_oracle))
        yield f"{package}, {kind}", one.reading, f"`{one.formula}`", trace, said, law


def _cells(cells: Sequence[Cell]) -> str:
    signs = {True: "1", False: "0", None: "?"}
    return " ".join(signs[c] if c is None or isinstance(c, bool) else f"{c:g}" for c in cells)
