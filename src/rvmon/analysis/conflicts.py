"""Minimal sets of requirements that cannot all hold, and requirements that others imply."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Sequence
from itertools import combinations

from msgspec import Struct

from rvmon.analysis.product import Together
from rvmon.analysis.vacuity import Subject

MOST_OFFSETS = 12  # the most distances examined between the triggers of two requirements
MOST_ALWAYS = 4  # the most `always` requirements that are added to a pair

LARGEST_GROUP = 6
"""The size of the groups tried first: if all of a group can hold, so can every subset."""

LARGEST_SET = 5  # the size of the largest sets that are examined one by one
MOST_SETS = 2000  # sizes above three with more sets than this are skipped


class Member(Struct, frozen=True):
    """A requirement of a set, triggered `offset` ticks after the first trigger of the set."""

    subject: Subject
    offset: int = 0


class Conflict(Struct, frozen=True):
    """A minimal set of requirements that cannot all hold."""

    ids: tuple[str, ...]  # a requirement that is triggered twice occurs twice
    offsets: tuple[int, ...]  # for each id, the ticks from the first trigger to its own


class Implication(Struct, frozen=True):
    """A requirement that fails only where one of `by`, a minimal set, fails."""

    implied: str
    by: tuple[str, ...]


class ConflictSearch:
    """Searches for conflicts among requirements that can each pass alone."""

    def __init__(self, together: Together, subjects: Sequence[Subject], deadline: float) -> None:
        self.together = together
        self.subjects = subjects
        self.deadline = deadline
        self.conflicts: list[Conflict] = []  # found so far; no conflict contains another one
        self.sets_undecided = 0  # the number of larger sets examined but not decided
        # all sets of up to this size were examined; `None` if those of any size were
        self.whole_sets: int | None = 2
        self._always = [subject for subject in subjects if subject.is_always]
        self._pairs = [pair for pair in combinations(subjects, 2) if pair[0].names & pair[1].names]
        self._near = set(map(frozenset, self._pairs))
        self._open: set[frozenset[Subject]] = set(self._near)
        self._apart: set[frozenset[Subject]] = set()
        self._bad: list[frozenset[Subject]] = []
        self._fine: list[frozenset[Subject]] = []

    @property
    def pairs(self) -> int:
        """The number of pairs that read a common name."""
        return len(self._pairs)

    @property
    def pairs_undecided(self) -> int:
        """The number of these pairs that were not decided, or not reached before the deadline."""
        return len(self._open)

    def run(self) -> None:
        """Examine pairs triggered at once, groups, triples, pairs apart in time, larger sets."""
        # Cheap questions come first: pairs that never start together, conflicts, and satisfiable
        # groups answer most of the later questions.
        decided = set()
        for pair in self._pairs:
            if not self._is_late() and self._pair_at_once(*pair) is not None:
                decided.add(frozenset(pair))
        self._groups()
        level = self._sets_of(3, list(self._near))
        for subject, other in self._to_be_set_apart():
            if self._is_late():
                return
            self._pair_apart(subject, other)
            if frozenset((subject, other)) in decided:
                self._open.discard(frozenset((subject, other)))
        for size in range(4, LARGEST_SET + 1):
            level = self._sets_of(size, level)

    def _is_late(self) -> bool:
        return time.monotonic() > self.deadline

    def _can_hold(self, members: Sequence[Member]) -> bool | None:
        """Whether all members can pass if triggered at their offsets; `None` if not decided."""
        subjects = [member.subject for member in members]
        offsets = [member.offset for member in members]
        return self.together.can_reach(subjects, offsets, range(len(members)))

    def _pair_at_once(self, subject: Subject, other: Subject) -> bool | None:
        """Whether two can pass if triggered at one instant; a conflict is recorded."""
        if self.together.can_start([subject, other]) is False:
            self._apart.add(frozenset((subject, other)))
            return True
        holds = self._can_hold([Member(subject), Member(other)])
        if holds is False:
            self._keep([Member(subject), Member(other)])
        return holds

    def _to_be_set_apart(self) -> Iterator[tuple[Subject, Subject]]:
        """The pairs to be examined with time between their triggers, in order.

        First each requirement with itself, then pairs that read a common name, then pairs
        connected by an `always` requirement that shares a name with both.
        """
        yield from ((subject, subject) for subject in self.subjects if subject.starts_again)
        yield from self._pairs
        for subject, other in combinations(self.subjects, 2):
            if frozenset((subject, other)) not in self._near and any(
                subject.names & always.names and other.names & always.names
                for always in self._always
            ):
                yield subject, other

    def _pair_apart(self, subject: Subject, other: Subject) -> None:
        """Examine two requirements, or one triggered twice, at several distances of triggers."""
        orders = [(subject, other)] if subject is other else [(subject, other), (other, subject)]
        for first, second in orders:
            if second.starts_late and not first.is_always:
                for offset in _offsets(first, second):
                    if self._is_late() or self._apart_by(first, second, offset):
                        return

    def _apart_by(self, first: Subject, second: Subject, offset: int) -> bool:
        """Whether two at this distance have a new conflict, alone or with `always` requirements."""
        names = first.names | second.names
        always = [
            Member(subject)
            for subject in self._always
            if subject not in (first, second) and subject.names & names
        ]
        members = [Member(first), Member(second, offset), *always[:MOST_ALWAYS]]
        holds = self._can_hold(members)
        # The product was too large. Try without the `always` requirements: a conflict of fewer
        # requirements is one of all.
        if holds is None:
            members = members[:2]
            holds = self._can_hold(members)
        return holds is False and self._keep(self._minimal(members))

    def _minimal(self, members: list[Member]) -> list[Member]:
        """A minimal conflicting subset of conflicting members, with offsets from 0."""
        for member in list(members):
            rest = [other for other in members if other is not member]
            if len(rest) > 1 and self._can_hold(rest) is False:
                members = rest
        start = min(member.offset for member in members)
        return [Member(member.subject, member.offset - start) for member in members]

    def _keep(self, members: Sequence[Member]) -> bool:
        """Record a conflict; returns whether it was recorded.

        It is not if it contains a known conflict, or if the triggers alone prevent some member
        from passing.
        """
        group = frozenset(member.subject for member in members)
        if any(bad <= group for bad in self._bad):
            return False
        subjects = [member.subject for member in members]
        offsets = [member.offset for member in members]
        for place in range(len(members)):
            if not self.together.can_reach(subjects, offsets, [place]):
                return False
        self._bad.append(group)
        conflict = Conflict(tuple(subject.id for subject in subjects), tuple(offsets))
        self.conflicts.append(conflict)
        return True

    # Sets of more than two, triggered at one instant.

    def _groups(self) -> None:
        """Find groups that can hold as a whole, which settles all their subsets with one query.

        Each group starts from one requirement, adds related ones, and shrinks until it can hold.
        """
        for subject in self.subjects:
            if self._is_late():
                return
            group = [subject]
            for other in self.subjects:
                if len(group) < LARGEST_GROUP and self._fits(group, other):
                    group.append(other)
            while len(group) > 2 and not self._is_late() and not self._is_fine(frozenset(group)):
                if self._can_hold([Member(subject) for subject in group]):
                    self._fine.append(frozenset(group))
                group.pop()

    def _fits(self, group: Collection[Subject], other: Subject) -> bool:
        """Whether a group can take one more requirement.

        It must share a name with a member, and bring neither a known conflict nor a pair that never
        starts together.
        """
        near = (frozenset((subject, other)) in self._near for subject in group)
        together = frozenset((*group, other))
        return other not in group and any(near) and not self._is_hopeless(together)

    def _is_hopeless(self, group: frozenset[Subject]) -> bool:
        """Whether a group contains a conflict, or a pair that never starts together."""
        pairs = map(frozenset, combinations(group, 2))
        return any(bad <= group for bad in self._bad) or any(p in self._apart for p in pairs)

    def _is_fine(self, group: frozenset[Subject]) -> bool:
        return any(group <= known for known in self._fine)

    def _sets_of(self, size: int, level: Sequence[frozenset[Subject]]) -> list[frozenset[Subject]]:
        """Examine the sets of one size, which extend those of the previous size (`level`).

        Returns:
            The sets; empty if there are none, or if not all sets of the previous or of this size
            were examined.
        """
        if self.whole_sets != size - 1:
            return []
        larger = list(dict.fromkeys(self._grown(level)))
        if self._is_late():
            return []
        if not larger:
            self.whole_sets = None
        if size > 3 and len(larger) > MOST_SETS:
            return []
        for group in larger:
            if self._is_late():
                return []
            self._look_at(group)
        if larger:
            self.whole_sets = size
        return larger

    def _grown(self, level: Sequence[frozenset[Subject]]) -> Iterator[frozenset[Subject]]:
        for group in level:
            if self._is_late():
                return
            if not self._is_hopeless(group):
                for other in self.subjects:
                    if self._fits(group, other):
                        yield group | {other}

    def _look_at(self, group: frozenset[Subject]) -> None:
        if self._is_fine(group) or self._is_hopeless(group):
            return
        members = [Member(subject) for subject in self.subjects if subject in group]
        holds = self._can_hold(members)
        self.sets_undecided += holds is None
        if holds is False:
            self._keep(self._minimal(members))


def _offsets(first: Subject, second: Subject) -> list[int]:
    """Distances (ticks) at which bounds of the two coincide, within a tick; round ones first."""
    theirs = {0, *_cuts(second)}
    distances = {a - b + step for a in _cuts(first) for b in theirs for step in (-1, 0, 1)}
    later = (at for at in distances if at > 0)
    return sorted(later, key=lambda at: (len(str(at).rstrip("0")), at))[:MOST_OFFSETS]


def _cuts(subject: Subject) -> set[int]:
    return set() if subject.automaton is None else subject.automaton.cuts


MOST_OTHERS = 5  # the most requirements that are tried together as premises of an implication


def implications_among(
    together: Together,
    subjects: Sequence[Subject],
    fallible: Sequence[Subject],
    conflicts: Sequence[Conflict],
    deadline: float,
) -> tuple[list[Implication], bool]:
    """The requirements that one or several others imply, each with a minimal set of these.

    Only requirements in `fallible`, which can fail, are tested. Sets with a conflict are excluded
    as premises, because they would imply anything.

    Returns:
        The implications, and whether all requirements were tested. If requirements imply each
        other, the later ones are reported as implied.
    """
    implications: list[Implication] = []
    # An implied requirement is not used as a premise, or two equivalent ones would both be dropped.
    dropped: set[str] = set()
    bad = [frozenset(conflict.ids) for conflict in conflicts]
    for implied in reversed(fallible):
        if time.monotonic() > deadline:
            return implications[::-1], False
        others = [
            other
            for other in subjects
            if other is not implied
            and other.id not in dropped
            and other.names & implied.names
            and starts_with(together, other, implied)
        ]
        by_one = [other for other in others if _implies(together, [other], implied)][:1]
        by = by_one or _by_several(together, implied, others, bad)
        if by:
            dropped.add(implied.id)
            implications.append(Implication(implied.id, tuple(subject.id for subject in by)))
    return implications[::-1], True


def starts_with(together: Together, other: Subject, implied: Subject) -> bool:
    """Whether an attempt of `other` starts or is open wherever one of `implied` starts."""
    ours, theirs = implied.requirement, other.requirement
    if theirs.captured or ours.captured:
        return False
    if other.is_always:
        return True
    if other.trigger is implied.trigger and theirs.mode is ours.mode:
        return True
    if not (other.starts_again and implied.starts_again):
        return False
    letters = together.letters([other, implied])
    return letters is not None and all(mine or not one for (_, mine), (_, one) in letters)


def _by_several(
    together: Together, implied: Subject, others: Sequence[Subject], bad: Sequence[frozenset[str]]
) -> list[Subject] | None:
    by: list[Subject] = []
    for other in others:
        ids = {subject.id for subject in (*by, other)}
        if len(by) < MOST_OTHERS and not any(conflict <= ids for conflict in bad):
            by.append(other)
    if len(by) < 2 or not _implies(together, by, implied):
        return None
    for other in list(by):
        rest = [subject for subject in by if subject is not other]
        if _implies(together, rest, implied):
            by = rest
    return by


def _implies(together: Together, by: Sequence[Subject], implied: Subject) -> bool:
    """Whether `implied` cannot fail if all of `by` pass, and all can pass together."""
    group, places = [*by, implied], range(len(by) + 1)
    if together.can_reach(group, [0] * len(group), places[:-1], places[-1:]) is not False:
        return False
    return together.can_reach(group, [0] * len(group), places) is True
