"""What is to be covered, as data: groups of items, each with a goal."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

from rvmon.spec.checked.goals import BinKind

STATES = "states"
TRANSITIONS = "transitions"
PAIRS = "pairs of transitions"
"""Names of the groups of a system's own states; the items of the last two are joined by arrows."""


class Subject(StrEnum):
    """What the items of a group are."""

    COVERPOINT = "coverpoint"
    CROSS = "cross"
    GOAL = "cover goal"
    REQUIREMENT = "requirement"
    STATES = "states"
    TRANSITIONS = "transitions"
    STATEMENTS = "statements"
    BRANCHES = "branches"


@dataclass(frozen=True, slots=True)
class Item:
    """One thing that may be hit: a bin, a combination of bins, a state, a line.

    Attributes:
        name: unique in its group.
        kind: what a hit means: progress, nothing, or an error.
        goal: hits that it needs.
        text: what it is, for people: a condition, a line of code; empty where the name says it.
    """

    name: str
    kind: BinKind = BinKind.GOAL
    goal: int = 1
    text: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """The items of one subject.

    Attributes:
        name: unique in its model.
        subject: what they are.
        items: by name, in order.
        weight: of the group in the total; 0: it is shown, and counts for nothing.
        axes: of a cross, the bins of each of its coverpoints by that one's name; its items are
            named by `combination`.
        title: what it is about, for people, such as the text of a requirement.
    """

    name: str
    subject: Subject
    items: Mapping[str, Item]
    weight: int = 1
    axes: Mapping[str, Sequence[str]] = field(default_factory=dict)
    title: str = ""


@dataclass(frozen=True, slots=True)
class Model:
    """All that runs of a system should show.

    Attributes:
        groups: by name, in order.
    """

    groups: Mapping[str, Group]

    def goals_of(self, group: str) -> list[tuple[str, str]]:
        """What is to be hit of a group, by names of group and item; none if there is no such."""
        items = self.groups[group].items if group in self.groups else {}
        return [(group, one.name) for one in items.values() if one.kind is BinKind.GOAL]


def combination(bins: Sequence[str]) -> str:
    """The name of the item of a cross that has one bin of each axis, in the order of the axes.

    >>> combination(["yes", "touch"]), combination(["yes", "a × b"])
    ('yes × touch', 'yes × `a × b`')
    """
    return " × ".join(f"`{one}`" if "×" in one else one for one in bins)


def group_of(
    name: str, subject: Subject, items: Sequence[Item], weight: int = 1, title: str = ""
) -> Group:
    """A group without axes.

    Raises:
        ValueError: two items have one name.
    """
    named = {item.name: item for item in items}
    if len(named) < len(items):
        raise ValueError(f"two items of `{name}` have one name")
    return Group(name, subject, named, weight, title=title)


def model_of(groups: Sequence[Group]) -> Model:
    """A model of some groups.

    Raises:
        ValueError: two groups have one name.

    >>> gaze = group_of("gaze", Subject.COVERPOINT, [Item("yes"), Item("no", goal=3)])
    >>> [*model_of([gaze]).groups]
    ['gaze']
    """
    named = {group.name: group for group in groups}
    if len(named) < len(groups):
        double = next(one.name for one in groups if named[one.name] is not one)
        raise ValueError(f"two groups of one name: `{double}`")
    return Model(named)


def without(model: Model, items: Collection[tuple[str, str]]) -> Model:
    """A model in which some items, by group and name, have no goal.

    >>> gaze = group_of("gaze", Subject.COVERPOINT, [Item("yes"), Item("no")])
    >>> without(model_of([gaze]), [("gaze", "no")]).groups["gaze"].items["no"].kind.value
    'ignore'
    """
    groups = dict(model.groups)
    for group, item in items:
        known = groups[group].items
        left = {**known, item: replace(known[item], kind=BinKind.IGNORE)}
        groups[group] = replace(groups[group], items=left)
    return Model(groups)
