"""Where peers and the law differ, each with a trace that shows it.

    python -m benchmarks.peers.differences

Every row is run on both sides; a peer that answers otherwise than written here has changed.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import spelling
from benchmarks.peers.environment import Environment, prepare
from benchmarks.peers.positions import Question, answers, ask_oracle
from benchmarks.peers.ways import Cell, Columns
from tests.tools.build import (
    always,
    compared,
    eventually,
    fall,
    historically,
    no,
    once,
    p,
    previous,
    q,
    two,
    x,
)

from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.specification import TimeModel


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
    time: TimeModel = TimeModel.SAMPLED


_T, _F = True, False
_P = "(v_p > 0.5)"
_Q = "(v_q > 0.5)"
_NAN = float("nan")

DIFFERENCES = (
    Difference(
        "reelay",
        "reelay",
        "discrete",
        "what is not known is false, its negation true",
        "not{v_p}",
        {"p": [None, _T, None]},
        [_T, _F, _T],
        no(p),
    ),
    Difference(
        "reelay",
        "reelay",
        "discrete",
        "`[0:0]` is read as `[0:]`",
        "once[0:0]{v_p}",
        {"p": [_T, _F]},
        [_T, _T],
        once(p, 0, 0),
    ),
    Difference(
        "reelay",
        "reelay",
        "discrete",
        "what follows a whole formula is dropped in silence: `xor`, `<->`, a second `->`",
        "{v_p} xor {v_q}",
        {"p": [_T, _T], "q": [_T, _F]},
        [_T, _T],
        two(p, "xor", q),
    ),
    Difference(
        "reelay",
        "reelay",
        "discrete",
        "a syntax error ends the process",
        "v_p",
        {"p": [_T]},
        "its process ended",
        p,
    ),
    Difference(
        "reelay",
        "reelay",
        "discrete robustness",
        "`since` from above 0 does not ask for its left operand at all instants",
        "{v_p > 0.5} since[1:1] {v_q > 0.5}",
        {"p": [_F, _F], "q": [_T, _T]},
        [_F, _T],
        two(p, "S", q, 1, 1),
    ),
    Difference(
        "reelay",
        "reelay",
        "dense",
        "`since` wants its left operand now, even where the right one is true now",
        "{v_p} since {v_q}",
        {"p": [_F, _F], "q": [_T, _T]},
        [_F, _F],
        two(p, "S", q),
        TimeModel.HELD,
    ),
    Difference(
        "reelay",
        "reelay",
        "dense",
        "dense time: the left operand is wanted between the ticks, too",
        "{v_p} since[1:1] {v_q}",
        {"p": [_F, _T, _T], "q": [_T, _T, _T]},
        [_F, _F, _T],
        two(p, "S", q, 1, 1),
        TimeModel.HELD,
    ),
    Difference(
        "reelay",
        "reelay",
        "dense sparse",
        "the Python package does not print a change to false and back within one stretch of input",
        "once[1:4]{v_p}",
        {"p": [_T, _F, _F, _F, _F, _T, _T, _T]},
        [_F, _T, _T, _T, _T, _T, _T, _T],
        once(p, 1, 4),
        TimeModel.HELD,
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "nothing is open at the end: what is beyond it fulfils `always`, not `eventually`",
        f"eventually[0:2]{_P}",
        {"p": [_F, _F]},
        [_F, _F],
        eventually(p, 0, 2),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "the same, for `always`",
        f"always[0:2]{_P}",
        {"p": [_T, _T]},
        [_T, _T],
        always(p, 0, 2),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "`prev` is true at the first position (`s_prev` is false there, as ours)",
        f"prev{_P}",
        {"p": [_F, _F]},
        [_T, _F],
        previous(p),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "`fall` is true at the first position where its operand is false",
        f"fall{_P}",
        {"p": [_F, _F]},
        [_T, _F],
        fall(p),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "robustness of `iff` and of `==` is never above 0: true looks as undecided",
        f"{_P} iff {_Q}",
        {"p": [_T, _T], "q": [_T, _F]},
        [None, _F],
        two(p, "<->", q),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete",
        "NaN counts or not, by the order in which it is met",
        "once[0:1](v_x > 0.5)",
        {"x": [0.0, _NAN, 0.0]},
        [_F, _F, None],
        once(compared(x, ">", 0.5), 0, 1),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "dense",
        "`until` and `since` want the left operand also at the instant of the right one",
        f"{_P} until[0:3] {_Q}",
        {"p": [_T, _F, _F, _F], "q": [_F, _T, _F, _F]},
        [_F, _F, _F, _F],
        two(p, "U", q, 0, 3),
        TimeModel.HELD,
    ),
    Difference(
        "rtamt",
        "rtamt",
        "dense",
        "a first stretch of `since` with robustness -inf is lost: operators above do not see it",
        f"historically[0:1]({_P} since (once[1:1]{_P}))",
        {"p": [_T, _T, _T]},
        [None, _T, _T],
        historically(two(p, "S", once(p, 1, 1)), 0, 1),
        TimeModel.HELD,
    ),
    Difference(
        "rtamt",
        "rtamt",
        "dense",
        "the same: so `or` is false there although its other operand is true",
        f"once[1:1](({_P} since (once[1:1]{_P})) or {_Q})",
        {"p": [_T, _T, _T], "q": [_T, _T, _T]},
        [_F, _F, _T],
        once(two(two(p, "S", once(p, 1, 1)), "or", q), 1, 1),
        TimeModel.HELD,
    ),
    Difference(
        "rtamt",
        "rtamt",
        "discrete online",
        "a timed formula that stands twice is moved on twice a sample",
        f"(not(once[0:1]{_P})) and s_prev(once[0:1]{_P})",
        {"p": [_T, _F, _F]},
        [_F, _F, _F],
        fall(once(p, 0, 1)),
    ),
    Difference(
        "rtamt",
        "rtamt",
        "dense online",
        "future operators have no effect: the operand itself is answered",
        f"always[0:1]{_P}",
        {"p": [_T, _F, _T, _T]},
        [_T, _F, _T, _T],
        always(p, 0, 1),
        TimeModel.HELD,
    ),
    Difference(
        "mstlo-python",
        "mstlo",
        "DelayedQualitative",
        "`until` wants the left operand also at the instant of the right one",
        f"{_P} U[0, 1] {_Q}",
        {"p": [_T, _F, _F], "q": [_F, _T, _F]},
        [_F, _F, None],
        two(p, "U", q, 0, 1),
        TimeModel.HELD,
    ),
    Difference(
        "mstlo-python",
        "mstlo",
        "DelayedQualitative",
        "NaN fulfils `>=` (read as `not <`) and not `>`",
        "v_x >= 0.5",
        {"x": [1.0, _NAN, 0.0]},
        [_T, _T, _F],
        compared(x, ">=", 0.5),
        TimeModel.HELD,
    ),
)


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


def main() -> int:
    """Print the table."""
    print("\n".join(table(prepare())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
