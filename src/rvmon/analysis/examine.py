"""A whole specification examined: what it cannot do, within a budget of time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from rvmon.analysis.possible import Possible, possible
from rvmon.analysis.subject import Conflict, Implication, Subject
from rvmon.analysis.together import Aim, Together
from rvmon.spec.checked import CheckedSpec

MOST_OFFSETS = 12
"""Of two requirements so many distances between their triggers are looked at."""


@dataclass(frozen=True, slots=True)
class Examination:
    """What was found.

    Attributes:
        possible: by requirement.
        conflicts: minimal sets that cannot all hold.
        implications: those that others make superfluous.
        undecided: ids of which it was not decided whether they can trigger, fail and pass.
        pairs: how many pairs that read a common name were looked at.
        pairs_undecided: how many of these were not decided, or not reached within the budget.
        triples_done: whether all sets of three that read common names were looked at.
    """

    possible: Mapping[str, Possible]
    conflicts: tuple[Conflict, ...]
    implications: tuple[Implication, ...]
    undecided: tuple[str, ...]
    pairs: int
    pairs_undecided: int
    triples_done: bool


def examine(spec: CheckedSpec, subjects: Sequence[Subject], seconds: float) -> Examination:
    """Examine requirements, each alone, by two, by three.

    Args:
        spec: declares the names.
        subjects: its requirements.
        seconds: the budget; what is not reached counts as not decided.
    """
    deadline = time.monotonic() + seconds
    found: dict[str, Possible] = {}
    for subject in subjects:
        if time.monotonic() > deadline:
            break
        requirement = subject.requirement
        found[subject.id] = possible(spec, subject.trigger, subject.automaton, requirement.at_end)
    undecided = tuple(
        subject.id
        for subject in subjects
        if (one := found.get(subject.id)) is None
        or (one.trigger is not False and None in (one.trigger, one.fail, one.pass_))
    )
    harmless = frozenset(name for name, one in found.items() if one.fail is False)
    pairing = _Pairing(spec, [s for s in subjects if _is_sound(s, found)], harmless, deadline)
    pairing.run()
    return Examination(
        found,
        tuple(pairing.conflicts),
        tuple(pairing.implications),
        undecided,
        pairing.pairs,
        pairing.undecided,
        pairing.triples_done,
    )


def _is_sound(subject: Subject, found: Mapping[str, Possible]) -> bool:
    """Whether a requirement can be met by itself, as far as is known."""
    one = found.get(subject.id)
    if one is None or subject.trigger is None or subject.automaton is None:
        return False
    return one.trigger is True and one.pass_ is True


class _Pairing:
    def __init__(
        self,
        spec: CheckedSpec,
        subjects: Sequence[Subject],
        harmless: frozenset[str],
        deadline: float,
    ) -> None:
        self.together = Together(spec)
        self.subjects = subjects
        self.deadline = deadline
        self.conflicts: list[Conflict] = []
        self.implications: list[Implication] = []
        self.harmless = harmless
        self.pairs = self.undecided = 0
        self.triples_done = True

    def run(self) -> None:
        """Look at pairs that read a common name, then at triples of which no pair conflicts."""
        near = [pair for pair in combinations(self.subjects, 2) if pair[0].names & pair[1].names]
        self.pairs = len(near)
        for pair in near:
            if self._late():
                self.undecided += 1
            else:
                self._pair(*pair)
        for triple in self._triples(near):
            if self._late():
                self.triples_done = False
                return
            self._conflict(triple, (0, 0, 0))

    def _late(self) -> bool:
        return time.monotonic() > self.deadline

    def _pair(self, first: Subject, second: Subject) -> None:
        together = self._conflict((first, second), (0, 0))
        self.undecided += together is None
        if together is False and self._implication(first, second):
            return
        for one, other in ((first, second), (second, first)):
            for offset in () if together else _offsets(one, other):
                if self._late() or self._conflict((one, other), (0, offset)):
                    return

    def _conflict(self, group: tuple[Subject, ...], offsets: tuple[int, ...]) -> bool | None:
        """Whether each can be met when all are triggered, but not all; found ones are kept."""
        places = range(len(group))
        together = self.together.can_reach(group, offsets, Aim(frozenset(places)))
        if together is not False:
            return None if together is None else False
        for place in places:
            if not self.together.can_reach(group, offsets, Aim(frozenset([place]))):
                return False
        self.conflicts.append(Conflict(tuple(subject.id for subject in group), offsets))
        return True

    def _implication(self, first: Subject, second: Subject) -> bool:
        """Whether one fails only where the other does; a found one is kept."""
        if first.trigger is not second.trigger or not _alike(first, second):
            return False
        aim = Aim(frozenset([0]), frozenset([1]))
        for by, implied in ((first, second), (second, first)):
            if implied.id in self.harmless:
                continue
            if self.together.can_reach((by, implied), (0, 0), aim) is False:
                self.implications.append(Implication(implied.id, by.id))
                return True
        return False

    def _triples(
        self, near: Sequence[tuple[Subject, Subject]]
    ) -> Iterator[tuple[Subject, Subject, Subject]]:
        known = {frozenset(pair) for pair in near}
        bad = {frozenset(conflict.ids) for conflict in self.conflicts}
        for first, second, third in combinations(self.subjects, 3):
            pairs = [frozenset(pair) for pair in combinations((first, second, third), 2)]
            if sum(pair in known for pair in pairs) < 2:
                continue
            if not any(frozenset(s.id for s in pair) in bad for pair in pairs):
                yield first, second, third


def _alike(first: Subject, second: Subject) -> bool:
    """Whether equal triggers start their attempts at the same instants."""
    one, other = first.requirement, second.requirement
    same = one.mode is other.mode and one.for_each == other.for_each
    return same and not one.captures and not other.captures


def _offsets(first: Subject, second: Subject) -> list[int]:
    """Distances at which windows of the two begin or end together."""
    ours, theirs = _cuts(first), {0, *_cuts(second)}
    return sorted({a - b for a in ours for b in theirs if a > b})[:MOST_OFFSETS]


def _cuts(subject: Subject) -> set[int]:
    locations = () if subject.automaton is None else subject.automaton.locations
    return {cut for location in locations for clock in location.cuts for cut in clock}
