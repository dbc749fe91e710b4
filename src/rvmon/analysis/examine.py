"""A whole specification examined: what it cannot do, within a budget of time."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.analysis.implied import implications_among
from rvmon.analysis.possible import Possible, possible
from rvmon.analysis.sets import ConflictSearch
from rvmon.analysis.subject import Conflict, Implication, Subject
from rvmon.analysis.together import Together
from rvmon.spec.checked.specification import CheckedSpec


@dataclass(frozen=True, slots=True)
class Examination:
    """What was found.

    Attributes:
        possible: by requirement.
        conflicts: minimal sets that cannot all hold.
        implications: requirements that others make superfluous.
        undecided: ids of which it was not decided whether they can trigger, fail and pass.
        pairs: how many pairs that read a common name were looked at.
        pairs_undecided: how many of these were not decided, or not reached within the budget.
        sets_undecided: how many larger sets that were looked at were not decided.
        whole_sets: sets of up to so many requirements were all looked at; `None` if those of any
            size were.
        implications_done: whether all requirements were looked at whether others imply them.
    """

    possible: Mapping[str, Possible]
    conflicts: tuple[Conflict, ...]
    implications: tuple[Implication, ...]
    undecided: tuple[str, ...]
    pairs: int
    pairs_undecided: int
    sets_undecided: int
    whole_sets: int | None
    implications_done: bool


def examine(spec: CheckedSpec, subjects: Sequence[Subject], seconds: float) -> Examination:
    """Examine requirements, each alone, by two, by more.

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
    sound = [subject for subject in subjects if _is_sound(subject, found)]
    together = Together(spec)
    search = ConflictSearch(together, sound, deadline)
    search.run()
    falling = [subject for subject in sound if found[subject.id].fail is not False]
    implications, done = implications_among(together, sound, falling, search.conflicts, deadline)
    return Examination(
        found,
        tuple(search.conflicts),
        tuple(implications),
        undecided,
        search.pairs,
        search.pairs_undecided,
        search.sets_undecided,
        search.whole_sets,
        done,
    )


def _is_sound(subject: Subject, found: Mapping[str, Possible]) -> bool:
    """Whether a requirement can be met by itself, as far as is known."""
    one = found.get(subject.id)
    if one is None or subject.trigger is None or subject.automaton is None:
        return False
    return one.trigger is True and one.pass_ is True
