"""Differences between peers and the semantics, each with a trace that shows it.

Every row is run on both sides. If a peer gives another answer than recorded here, it has changed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import spelling
from benchmarks.peers.environment import Environment
from benchmarks.peers.ways import Cell, Columns, Question, answers, ask_oracle
from benchmarks.program import table

from rvmon import loads


class Difference(msgspec.Struct, frozen=True):
    """One point in which a peer reads a formula or a trace differently."""

    # its package, its adapter class, and the kind of time and semantics for the adapter
    peer: tuple[str, str, str]
    reading: str  # the peer's, in words
    formula: str  # in the peer's language
    answer: str  # the peer's, tick by tick (the sign of a robustness), or the start of its error
    trace: dict[str, list[Cell | str]]
    same: str  # the formula of rvmon that looks the same
    time: str  # the time model of rvmon

    def question(self) -> Question:
        """The formula and the trace for rvmon."""
        spec = loads(
            f"time {self.time}\nsignal p, q : bool\nsignal x : real\n"
            f"requirement R\n  upon start then {self.same}\n"
        ).checked
        columns = {
            name: [None if isinstance(cell, str) else cell for cell in cells]
            for name, cells in self.trace.items()
        }
        return Question(spec.requirements["R"].consequent, columns, spec.time)


_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))["difference"]
DIFFERENCES = msgspec.convert(_TABLE, list[Difference])


def _answer(one: Difference, columns: Columns, environment: Environment) -> str:
    _, adapter, kind = one.peer
    named = {spelling(name): list(cells) for name, cells in columns.items()}
    with Peer(environment.python, adapter) as peer:
        try:
            found = peer.ask("judge", formula=one.formula, kind=kind, columns=named)["values"]
        except PeerError as error:
            return str(error)
    if "robustness" in kind or adapter == "Rtamt":
        return _cells([None if not value or value != value else value > 0 for value in found])
    return _cells([None if value is None else bool(value) for value in found])


def lines(environment: Environment) -> Iterator[str]:
    """The differences as a table; peers that are missing are left out."""
    head = ("peer", "reading", "its formula", "trace", "it says", "the law")
    return table(head, _rows(environment))


def _rows(environment: Environment) -> Iterator[Sequence[str]]:
    for one in DIFFERENCES:
        package, _, kind = one.peer
        if package not in environment.versions:
            continue
        question = one.question()
        found = _answer(one, question.columns, environment)
        if not found.startswith(one.answer):
            raise AssertionError(f"{package} has changed: {one}: {found}")
        trace = "; ".join(f"{name} {_cells(c)}" for name, c in question.columns.items())
        law = _cells(answers(question, ask_oracle))
        yield f"{package}, {kind}", one.reading, f"`{one.formula}`", trace, found, law


def _cells(cells: Sequence[Cell]) -> str:
    signs = {True: "1", False: "0", None: "?"}
    return " ".join(signs[c] if c is None or isinstance(c, bool) else f"{c:g}" for c in cells)
