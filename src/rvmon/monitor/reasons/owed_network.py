"""What an undecided formula still asks for, by what a network knows."""

from __future__ import annotations

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
from rvmon.monitor.reasons.obligation_words import Words, all_of
from rvmon.trace.time import format_ticks


def owed_at(network: Network, core: Core, position: int, words: Words) -> str:
    """What a formula at a position asks for, as text; empty if it is decided."""
    return _Owing(network, words).at(core, position)


class _Owing:
    def __init__(self, network: Network, words: Words) -> None:
        self.network = network
        self.words = words
        self.gap = network.positions.gap

    def at(self, core: Core, position: int) -> str:
        if self.network.value_at(core, position) is not None:
            return ""
        match core:
            case Constant() | Literal():
                return ""
            case And(args=args):
                return all_of([self.at(arg, position) for arg in args])
            case Or(args=args):
                found = dict.fromkeys(self.at(arg, position) for arg in args)
                return ", or ".join(part for part in found if part)
            case Next() | Previous() | Since():
                return f"`{self.words.text(core)}`"
            case Until(high=high):
                return self._own(core, "by", position, high)
            case Release(right=right, low=low, high=high):
                spawned = self._spawned(right, position - (-low // self.gap))
                own = self._own(core, "until", position, high)
                return all_of([spawned, own])
            case _:
                assert_never(core)

    def _own(self, core: Core, word: str, position: int, high: int | None) -> str:
        text = f"`{self.words.text(core)}`"
        if high is None:
            return text
        return f"{text} {word} {format_ticks(position * self.gap + high)}"

    def _spawned(self, core: Core, first: int) -> str:
        """What the first position asks for, of those from `first` on that are not known."""
        if isinstance(core, Literal | Constant):
            return ""
        position = self.network.first_unknown(core, first)
        return "" if position is None else self.at(core, position)
