"""What an undecided formula still asks for, by what a network knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import assert_never

from rvmon.dataflow.network import Network
from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Since,
    Until,
)
from rvmon.monitor.wording import Words
from rvmon.trace.time import format_ticks


@dataclass(frozen=True, slots=True)
class Owed:
    """What is asked for, as text, and until when it can be met; `None` if nothing bounds that."""

    text: str
    deadline: int | None


def owed_at(network: Network, core: Core, position: int, limit: int, words: Words) -> Owed | None:
    """What a formula at a position asks for at a stamp; `None` if it is decided.

    Args:
        network: what is known.
        core: the formula.
        position: as the network counts them.
        limit: the stamp.
        words: names the parts.
    """
    return _Owing(network, limit, words).at(core, position)


class _Owing:
    def __init__(self, network: Network, limit: int, words: Words) -> None:
        self.network = network
        self.limit = limit
        self.words = words
        self.gap = network.positions.gap

    def at(self, core: Core, position: int) -> Owed | None:
        if self.network.value_at(core, position, self.limit) is not None:
            return None
        match core:
            case Constant() | Literal():
                return None
            case And(args=args):
                return _joined(" and ", [self.at(arg, position) for arg in args])
            case Or(args=args):
                return _joined(", or ", [self.at(arg, position) for arg in args])
            case Next() | Previous() | Since():
                return Owed(f"`{self.words.text(core)}`", None)
            case Until(high=high):
                return self._own(core, "by", position, high)
            case Release(right=right, low=low, high=high):
                spawned = self._spawned(right, position - (-low // self.gap))
                own = self._own(core, "to", position, high)
                return _joined(" and ", [spawned, own])
            case _:
                assert_never(core)

    def _own(self, core: Core, word: str, position: int, high: int | None) -> Owed:
        text = f"`{self.words.text(core)}`"
        if high is None:
            return Owed(text, None)
        last = position * self.gap + high
        return Owed(f"{text} {word} {format_ticks(last)}", last)

    def _spawned(self, core: Core, first: int) -> Owed | None:
        """What the first position asks for, of those from `first` on that are not known."""
        if isinstance(core, Literal | Constant):
            return None
        position = self.network.first_unknown(core, first, self.limit)
        return None if position is None else self.at(core, position)


def _joined(word: str, parts: list[Owed | None]) -> Owed | None:
    """All parts, or one of them; the deadline is that of the first to be met, or of the last."""
    owed = list(dict.fromkeys(part for part in parts if part is not None))
    if not owed:
        return None
    deadlines = [part.deadline for part in owed if part.deadline is not None]
    if word == " and ":
        deadline = min(deadlines, default=None)
    else:
        deadline = max(deadlines) if len(deadlines) == len(owed) else None
    return Owed(word.join(part.text for part in owed), deadline)
