"""What a campaign measures itself: states and transitions of the robot, and its code."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.meter import code_groups
from rvmon.cdv.system import Run
from rvmon.coverage.hits import Hit
from rvmon.coverage.model import PAIRS, STATES, TRANSITIONS, Group, Item, Subject, group_of

_ARROW = " → "


def measured_groups(campaign: Campaign) -> list[Group]:
    """What there is to be covered; a group of which nothing is declared has no items.

    Raises:
        RvmonError: code is measured, and coverage.py is not installed, or a file is no Python.
    """
    declared = campaign.transitions
    transitions = permutations(campaign.states, 2) if declared is None else declared
    return [
        group_of(STATES, Subject.STATES, [*map(Item, campaign.states)]),
        group_of(TRANSITIONS, Subject.TRANSITIONS, [Item(_ARROW.join(one)) for one in transitions]),
        group_of(PAIRS, Subject.TRANSITIONS, [*map(Item, _pairs(declared or ()))]),
        *(code_groups(campaign.code) if campaign.code is not None else ()),
    ]


def _pairs(transitions: Sequence[tuple[str, str]]) -> list[str]:
    """Two transitions one after the other."""
    return [
        _ARROW.join((*first, second[1]))
        for first in transitions
        for second in transitions
        if first[1] == second[0]
    ]


def source_and_target(transition: str) -> tuple[str, str]:
    """The states of a transition, from its name."""
    source, _, target = transition.partition(_ARROW)
    return source, target


def hits_of_states(run: Run) -> dict[str, Mapping[str, Hit]]:
    """How often each state was entered and each transition taken, and when first."""
    names = [state for _, state in run.states]
    found = {STATES: _counted(run.states)}
    for group, length in ((TRANSITIONS, 2), (PAIRS, 3)):
        found[group] = _counted(
            (t_ns, _ARROW.join(names[end - length : end]))
            for end, (t_ns, _) in enumerate(run.states, start=1)
            if end >= length
        )
    return {group: items for group, items in found.items() if items}


def _counted(happened: Iterable[tuple[int, str]]) -> dict[str, Hit]:
    hits: dict[str, Hit] = {}
    for t_ns, name in happened:
        known = hits.get(name)
        hits[name] = Hit(1, t_ns) if known is None else Hit(known.count + 1, known.first)
    return hits
