"""Requirements that others make superfluous: they fail only where one of those fails."""

from __future__ import annotations

import time
from collections.abc import Sequence

from rvmon.analysis.product import Aim, Together
from rvmon.analysis.requirement import Conflict, Implication, Subject

MOST_OTHERS = 5
"""So many others are looked at together."""


def implications_among(
    together: Together,
    subjects: Sequence[Subject],
    falling: Sequence[Subject],
    conflicts: Sequence[Conflict],
    deadline: float,
) -> tuple[list[Implication], bool]:
    """The requirements that one or several others make superfluous, each with a minimal set.

    Args:
        together: answers about groups.
        subjects: the requirements that may imply another one.
        falling: those that can fail.
        conflicts: sets that cannot all hold: they would imply anything.
        deadline: of `time.monotonic`.

    Returns:
        The implications, and whether all requirements were looked at. Of requirements that imply
        each other the later ones are reported as implied.
    """
    found: list[Implication] = []
    dropped: set[str] = set()
    bad = [frozenset(conflict.ids) for conflict in conflicts]
    for implied in reversed(falling):
        if time.monotonic() > deadline:
            return found[::-1], False
        others = [
            other
            for other in subjects
            if other is not implied
            and other.id not in dropped
            and other.names & implied.names
            and starts_with(together, other, implied)
        ]
        by = _by_one(together, implied, others) or _by_several(together, implied, others, bad)
        if by:
            dropped.add(implied.id)
            found.append(Implication(implied.id, tuple(subject.id for subject in by)))
    return found[::-1], True


def starts_with(together: Together, other: Subject, implied: Subject) -> bool:
    """Whether an attempt of the other is under way wherever one of a requirement starts."""
    ours, theirs = implied.requirement, other.requirement
    if theirs.captures or theirs.for_each or ours.captures or ours.for_each:
        return False
    if other.is_always:
        return True
    if other.trigger is implied.trigger and theirs.mode is ours.mode:
        return True
    if not (other.starts_anew and implied.starts_anew):
        return False
    letters = together.letters([other, implied])
    return letters is not None and all(mine or not one for (_, mine), (_, one) in letters)


def _by_one(
    together: Together, implied: Subject, others: Sequence[Subject]
) -> list[Subject] | None:
    for other in others:
        if _implies(together, [other], implied):
            return [other]
    return None


def _by_several(
    together: Together,
    implied: Subject,
    others: Sequence[Subject],
    bad: Sequence[frozenset[str]],
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
    """Whether it cannot fail where all others end well, and all can."""
    group, places = [*by, implied], range(len(by) + 1)
    fails_alone = Aim(frozenset(places[:-1]), frozenset(places[-1:]))
    if together.can_reach(group, [0] * len(group), fails_alone) is not False:
        return False
    return together.can_reach(group, [0] * len(group), Aim(frozenset(places))) is True
