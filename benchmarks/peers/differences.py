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
from benchmarks.peers.positions import Question, answers, ask_oracle
from benchmarks.peers.ways import Cell, Columns

from rvmon import loads
from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.specification import TimeModel

TABLE = Path(__file__).with_name("differences.toml")


@dataclass(frozen=True, slots=True)
class Difference:
    """One point in which a peer reads a formula or a trace otherwise.

    Attributes:
        package: the peer's.
        worker: of the module that asks it.
        kind: what the worker is told of time and semantics.
        reading: the peer's, in words.
        formula: in the peer's language.
        columns: the trace, tick by tick; `None` is unknown.
        theirs: the peer's answer per tick, of a robustness the sign; or how its error begins.
        same: what looks like the same formula here.
        time: our time model.
    """

    package: str
    worker: str
    kind: str
    reading: str
    formula: str
    columns: Columns
    theirs: Sequence[Cell] | str
    same: Formula
    time: TimeModel


def _read() -> Iterator[Difference]:
    for one in tomllib.loads(TABLE.read_text(encoding="utf-8"))["difference"]:
        columns = {name: _known(cells) for name, cells in one["trace"].items()}
        answer = one["answer"]
        spec = loads(
            f"time {one['time']}\nsignal p, q : bool\nsignal x : real\n"
            f"requirement R\n  upon start then {one['same']}\n"
        ).checked
        yield Difference(
            *one["peer"],
            reading=one["reading"],
            formula=one["formula"],
            columns=columns,
            theirs=answer if isinstance(answer, str) else _known(answer),
            same=spec.requirements["R"].consequent,
            time=spec.time,
        )


def _known(cells: Sequence[Cell | str]) -> list[Cell]:
    return [None if cell == "?" else cell for cell in cells]


DIFFERENCES = tuple(_read())


def answer(peer: Peer, difference: Difference) -> list[Cell] | str:
    """What the peer says today."""
    columns = {spelling(name): list(column) for name, column in difference.columns.items()}
    try:
        found = peer.ask("judge", formula=difference.formula, kind=difference.kind, columns=columns)
    except PeerError as error:
        return str(error)
    values = found["values"]
    if "robustness" in difference.kind or difference.worker == "rtamt":
        return [None if not value or value != value else value > 0 for value in values]
    return [None if value is None else bool(value) for value in values]


def ours(difference: Difference) -> list[bool | None]:
    """What the law says."""
    question = Question(difference.same, difference.columns, frozenset(), difference.time)
    return answers(question, ask_oracle)


def as_written(difference: Difference, found: list[Cell] | str) -> bool:
    """Whether the peer still answers as is written here."""
    if isinstance(difference.theirs, str):
        return isinstance(found, str) and found.startswith(difference.theirs)
    return found == list(difference.theirs)


def table(environment: Environment) -> list[str]:
    """The differences as lines of a Markdown table; peers that are missing are left out."""
    lines = [
        "| peer | reading | its formula | trace | it says | the law |",
        "|---|---|---|---|---|---|",
    ]
    for difference in DIFFERENCES:
        if difference.package not in environment.versions:
            continue
        with Peer(environment.python, difference.worker) as peer:
            found = answer(peer, difference)
        if not as_written(difference, found):
            raise AssertionError(f"{difference.package} has changed: {difference}: {found}")
        trace = "; ".join(f"{name} {_cells(c)}" for name, c in difference.columns.items())
        said = found if isinstance(found, str) else _cells(found)
        lines.append(
            f"| {difference.package}, {difference.kind} | {_escaped(difference.reading)} | "
            f"`{_escaped(difference.formula)}` | {trace} | {said} | {_cells(ours(difference))} |"
        )
    return lines


def _cells(cells: Sequence[Cell]) -> str:
    signs = {True: "1", False: "0", None: "?"}
    return " ".join(signs[c] if c is None or isinstance(c, bool) else f"{c:g}" for c in cells)


def _escaped(text: str) -> str:
    return text.replace("|", "\\|")
