"""What the analyses know of a requirement, and which ages of its clocks lead alike."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

from rvmon.logic.automaton import NOW, Automaton
from rvmon.logic.clock_regions import region_bounds
from rvmon.logic.state_formula import State
from rvmon.spec.checked.formula import BoundAtom, Constant
from rvmon.spec.checked.specification import Mode, Requirement


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A requirement to be analysed.

    Attributes:
        requirement: as checked.
        trigger: starts an attempt; `None` if it is the end of the trace.
        automaton: of what an attempt owes; `None` if it does not close.
        names: the signals and events that what is required reads.
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
        """Whether it holds of every instant, so that an attempt is under way at each."""
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
    """A requirement of a set, triggered so many ticks after the first."""

    subject: Subject
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Conflict:
    """Requirements that cannot all hold.

    Attributes:
        ids: a minimal set; one that is triggered twice stands twice.
        offsets: for each how long after the first it is triggered, ticks.
    """

    ids: tuple[str, ...]
    offsets: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Implication:
    """A requirement that fails only where one of some others fails; a minimal set of those."""

    implied: str
    by: tuple[str, ...]


Regions = tuple[int, ...]
"""For each clock of a location how many of its cuts have been passed."""


def after_edge(automaton: Automaton, location: int, regions: Regions, edge: int) -> Regions:
    """The least regions behind an edge; locations may cut the age of one clock differently."""
    ours = automaton.locations[location].cuts
    theirs = automaton.locations[automaton.targets[edge]].cuts
    found = []
    for source, cuts in zip(automaton.sources[edge], theirs, strict=True):
        age = 0 if source == NOW else region_bounds(ours[source], regions[source])[0]
        found.append(bisect_right(cuts, age))
    return tuple(found)
