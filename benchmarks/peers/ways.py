"""The ways in which peers can be asked for the truth of a formula at every tick."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.peers import dialects
from benchmarks.peers.client import Peer
from benchmarks.peers.dialects import ALWAYS_ONE, Dialect, spelling, translate

from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.specification import TimeModel

Cell = bool | float | None
"""A value at a tick; `None`: not known."""

Columns = Mapping[str, Sequence[Cell]]
"""The value of each name at each tick, from tick 0 on; of an event, whether it occurs."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way to ask one peer.

    Attributes:
        name: of peer, time model and semantics.
        package: its name in the package index.
        worker: of the module that asks it.
        kind: what the worker is given of time and semantics.
        dialect: the language.
        time: the time model of ours that it stands for.
        sign: whether it answers with a robustness, whose sign counts; 0 says nothing.
    """

    name: str
    package: str
    worker: str
    kind: str
    dialect: Dialect
    time: TimeModel
    sign: bool = False


_HELD, _SAMPLED = TimeModel.HELD, TimeModel.SAMPLED
_REELAY = ("reelay", "reelay")
_RTAMT = ("rtamt", "rtamt")
_MSTLO = ("mstlo-python", "mstlo")
_SENTIL = ("sentil", "sentil")

WAYS = {
    way.name: way
    for way in (
        Way("reelay-discrete", *_REELAY, "discrete", dialects.REELAY_DISCRETE, _SAMPLED),
        Way(
            "reelay-discrete-robustness",
            *_REELAY,
            "discrete robustness",
            dialects.REELAY_ROBUSTNESS,
            _SAMPLED,
            sign=True,
        ),
        Way("reelay-dense", *_REELAY, "dense", dialects.REELAY_DENSE, _HELD),
        Way(
            "reelay-dense-robustness",
            *_REELAY,
            "dense robustness",
            dialects.REELAY_DENSE_ROBUSTNESS,
            _HELD,
            sign=True,
        ),
        Way("rtamt-discrete", *_RTAMT, "discrete", dialects.RTAMT_DISCRETE, _SAMPLED, sign=True),
        Way("rtamt-dense", *_RTAMT, "dense", dialects.RTAMT_DENSE, _HELD, sign=True),
        Way("mstlo-delayed", *_MSTLO, "DelayedQualitative", dialects.MSTLO, _HELD),
        Way("mstlo-robustness", *_MSTLO, "DelayedQuantitative", dialects.MSTLO, _HELD, sign=True),
        Way("sentil", *_SENTIL, "discrete", dialects.SENTIL, _SAMPLED, sign=True),
    )
}


def truths(way: Way, peer: Peer, formula: Formula, columns: Columns) -> list[bool | None]:
    """The peer's verdict at every tick; `None` where it has none.

    Raises:
        PeerError: it refuses, or dies.
        UntranslatableError: it cannot be asked this.
    """
    text = translate(formula, way.dialect)
    ticks = len(next(iter(columns.values())))
    named: dict[str, list[Cell]] = {spelling(n): list(column) for n, column in columns.items()}
    named[spelling("start")] = [tick == 0 for tick in range(ticks)]
    named[spelling(ALWAYS_ONE)] = [True] * ticks
    used = {name: column for name, column in named.items() if name in text}
    values = peer.ask("judge", formula=text, kind=way.kind, columns=used)["values"]
    if way.sign:
        return [None if value is None or value == 0 else value > 0 for value in values]
    return [None if value is None else bool(value) for value in values]
