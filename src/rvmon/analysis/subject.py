"""What the analyses know of a requirement: data."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.automaton import Automaton
from rvmon.formula.state import State
from rvmon.spec.checked import Requirement


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A requirement to be analysed.

    Attributes:
        requirement: as checked.
        trigger: starts an attempt; `None` if it is the end of the trace.
        automaton: of what an attempt owes; `None` if it does not close.
        names: the signals and events that what is owed reads.
    """

    requirement: Requirement
    trigger: State | None
    automaton: Automaton | None
    names: frozenset[str]

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.requirement.id


@dataclass(frozen=True, slots=True)
class Conflict:
    """Requirements that cannot all hold.

    Attributes:
        ids: a minimal set.
        offsets: for each how long after the first it is triggered, ticks.
    """

    ids: tuple[str, ...]
    offsets: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Implication:
    """A requirement that fails only where another one fails."""

    implied: str
    by: str
