"""The data of the analyses: requirements with their automata, conflicts, implications."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

from rvmon.language.checked.formula import BoundAtom, Constant
from rvmon.language.checked.specification import Mode, Requirement
from rvmon.logic.automaton import NOW, Automaton
from rvmon.logic.clock_regions import region_bounds
from rvmon.logic.state_formula import State


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A requirement to be analysed.

    Attributes:
        requirement: as checked.
        trigger: starts an attempt; `None` if it is the end of the trace.
        automaton: the automaton of the requirement; `None` if it does not close.
        names: the signals and events that it reads.
    """

    requirement: Requirement
    trigger: State | None
    automaton: Automaton | None
    names: frozenset[str]

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.requirement.id

    @property
    def is_always(self) -> bool:
        """Whether it is `whenever true`, so that an attempt is open at every instant."""
        trigger = self.requirement.trigger
        always = isinstance(trigger, Constant) and trigger.value
        return always and self.requirement.mode is Mode.WHENEVER

    @property
    def starts_late(self) -> bool:
        """Whether an attempt can start at another instant than the first."""
        return not self.is_always and not isinstance(self.requirement.trigger, BoundAtom)

    @property
    def starts_anew(self) -> bool:
        """Whether an attempt starts at every instant at which its trigger holds."""
        return self.requirement.pulse and self.requirement.mode is Mode.UPON


@dataclass(frozen=True, slots=True)
class Member:
    """A requirement of a set, triggered `offset` ticks after the first trigger of the set."""

    subject: Subject
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Conflict:
    """Requirements that cannot all hold.

    Attributes:
        ids: a minimal set; a requirement that is triggered twice occurs twice.
        offsets: for each, the ticks from the first trigger to its own.
    """

    ids: tuple[str, ...]
    offsets: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Implication:
    """A requirement that fails only where one of `by` fails; `by` is minimal."""

    implied: str
    by: tuple[str, ...]


Regions = tuple[int, ...]
"""For each clock of a location, the number of its cuts that its age has reached."""


def after_edge(automaton: Automaton, location: int, regions: Regions, edge: int) -> Regions:
    """The least possible regions after an edge, by the cuts of the target location."""
    ours = automaton.locations[location].cuts
    theirs = automaton.locations[automaton.targets[edge]].cuts
    found = []
    for source, cuts in zip(automaton.sources[edge], theirs, strict=True):
        age = 0 if source == NOW else region_bounds(ours[source], regions[source])[0]
        found.append(bisect_right(cuts, age))
    return tuple(found)
