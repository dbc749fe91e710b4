"""What judges attempts step by step."""

from __future__ import annotations

from typing import Any, Protocol

from rvmon.automaton.location import Token
from rvmon.formula.residual import Residual


class Machine(Protocol):
    """A deterministic timed monitor; tokens are values, so a machine serves any number of attempts.

    The location of a decided attempt is `FAILED` or `PASSED`.
    """

    @property
    def moves(self) -> Any:
        """What each edge does, worked out before; see `rvmon.runtime.table.moves_of`."""

    @property
    def start(self) -> Token:
        """The token of an attempt before the position of its trigger."""

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`, which is later than all before."""

    def stays(self, token: Token, t: int, letter: int, /) -> bool:
        """Whether a token that was stepped at `t` surely stays as it is under the same letter."""

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages, ascending, from which on it acts differently."""

    def time_value(self, token: Token, t: int) -> int:
        """The truth once time has come to `t` and no position came."""

    def residual(self, location: int) -> Residual:
        """What is owed in a location."""
