"""What is to be covered and what tests were seen to do, as data: items with goals, hits, records.

The other modules find hits, keep them in databases, and answer questions about them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar

from rvmon.spec.checked.goals import BinKind
from rvmon.verdict import Verdict
from rvmon.verdict.covered import CoveredBin, CoveredGroup

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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
    """All that runs of a system should show."""

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


@dataclass(frozen=True, slots=True)
class Hit:
    """How often an item was hit in one run, or in several.

    Attributes:
        count: at least 1.
        first: the instant of the first hit in ticks, where that is known.
    """

    count: int
    first: int | None = None

    def __reduce__(self) -> tuple[type[Hit], tuple[int, int | None]]:
        # Thousands of tests bring a hundred each from other processes.
        return Hit, (self.count, self.first)


Hits = Mapping[str, Mapping[str, Hit]]
"""By group and item; what was not hit is left out. A group or item that is no part of the model is
an error of whoever made them."""


@dataclass(frozen=True, slots=True)
class Score:
    """How much of something is covered.

    Attributes:
        items: that have a goal.
        covered: of these, that were hit as often as their goals ask for.
    """

    items: int
    covered: int


def merged(several: Iterable[Hits]) -> dict[str, dict[str, Hit]]:
    """The hits of several runs together: counts add up; an instant says nothing any more.

    >>> one = {"gaze": {"yes": Hit(2, 5)}}
    >>> merged([one, {"gaze": {"yes": Hit(1, 3), "no": Hit(1)}}])["gaze"]["yes"].count
    3
    """
    found: dict[str, dict[str, Hit]] = {}
    for hits in several:
        for group, items in hits.items():
            own = found.setdefault(group, {})
            for item, hit in items.items():
                own[item] = Hit(hit.count + (own[item].count if item in own else 0))
    return found


def count_of(hits: Hits, group: str, item: str) -> int:
    """How often an item was hit."""
    hit = hits.get(group, {}).get(item)
    return 0 if hit is None else hit.count


def is_covered(hits: Hits, group: Group, item: Item) -> bool:
    """Whether an item was hit as often as its goal asks for."""
    return count_of(hits, group.name, item.name) >= item.goal


def score(hits: Hits, group: Group) -> Score:
    """How much of a group is covered; what is ignored or illegal has no goal."""
    wanted = [item for item in group.items.values() if item.kind is BinKind.GOAL]
    return Score(len(wanted), sum(is_covered(hits, group, item) for item in wanted))


def share(hits: Hits, model: Model) -> float:
    """The share of a model that is covered: each subject counts alike, in it groups by weight.

    Returns:
        From 0 to 1, which stand for none and all alone; 1 if nothing is wanted.
    """
    return weighted((group, score(hits, group)) for group in model.groups.values())


def weighted(scores: Iterable[tuple[Group, Score]]) -> float:
    """The mean over subjects of the means of their groups by weights, rounded once.

    So a whole cross counts, however many requirements stand beside it. What has no items, or no
    weight, counts for nothing.

    >>> from rvmon.coverage import Subject
    >>> rest = [(Group(f"R{place}", Subject.REQUIREMENT, {}), Score(4, 4)) for place in range(99)]
    >>> weighted([*rest, (Group("situation", Subject.CROSS, {}), Score(8, 0))])
    0.5
    """
    subjects: dict[str, list[tuple[int, Score]]] = {}
    for group, one in scores:
        if one.items and group.weight:
            subjects.setdefault(group.subject, []).append((group.weight, one))
    means = [
        sum(Fraction(weight * one.covered, one.items) for weight, one in own)
        / sum(weight for weight, _ in own)
        for own in subjects.values()
    ]
    return float(sum(means) / len(means)) if means else 1.0


def illegal(hits: Hits, model: Model) -> list[tuple[Group, Item, Hit]]:
    """What was hit and must not be."""
    return [
        (group, item, hits[group.name][item.name])
        for group in model.groups.values()
        for item in group.items.values()
        if item.kind is BinKind.ILLEGAL and count_of(hits, group.name, item.name)
    ]


def covered_groups(hits: Hits, model: Model) -> tuple[CoveredGroup, ...]:
    """What one run hit of each group, and what not."""

    def covered(group: Group, item: Item) -> CoveredBin:
        hit = hits.get(group.name, {}).get(item.name)
        count, first = (0, None) if hit is None else (hit.count, hit.first)
        return CoveredBin(item.name, item.kind, item.goal, count, first)

    return tuple(
        CoveredGroup(
            group.name,
            group.subject.value,
            tuple(covered(group, item) for item in group.items.values()),
        )
        for group in model.groups.values()
    )


class Ending(StrEnum):
    """How a test ended."""

    COMPLETED = "completed"
    CRASHED = "crashed"
    HUNG = "hung"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class TestRecord:
    """A test of a campaign and what became of it, without what it hit.

    Attributes:
        name: for people; several tests may have one name.
        campaign: that it is part of.
        strategy: that made it; empty if none did, as for a recording from the field.
        recording: path of what was recorded; empty if that was not kept.
        seed: that it can be played again with.
        system: what was tested, such as a robot and its version.
        verdicts: by requirement.
        ending: how it ended.
        error: what went wrong if it did not complete, in words.
        number: its place in the campaign; tests with the same one are in the order of `when`.
        seconds: that it took.
        when: it was recorded, ns since 1970 in UTC; `None`: when it is written.
        expected: requirements that were known to fail, each with the reason.
        origin: the first instant of its run, ticks, from which instants are told.
    """

    __test__: ClassVar[bool] = False  # to pytest, which goes by names

    name: str
    campaign: str = ""
    strategy: str = ""
    recording: str = ""
    seed: int | None = None
    system: str = ""
    verdicts: Mapping[str, Verdict] = field(default_factory=dict)
    ending: Ending = Ending.COMPLETED
    error: str = ""
    number: int = 0
    seconds: float = 0.0
    when: int | None = None
    expected: Mapping[str, str] = field(default_factory=dict)
    origin: int = 0

    @property
    def failed(self) -> tuple[str, ...]:
        """The requirements that failed and were not known to."""
        return tuple(name for name in self._failed if name not in self.expected)

    @property
    def failed_as_expected(self) -> dict[str, str]:
        """The requirements that failed as they were known to, each with the reason."""
        return {name: self.expected[name] for name in self._failed if name in self.expected}

    @property
    def _failed(self) -> list[str]:
        return [name for name, verdict in self.verdicts.items() if verdict is Verdict.FAIL]


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """What a test hit, as columns in step.

    Attributes:
        items: that were hit, by their places in `Coverage.items`, ascending.
        counts: how often, at least once each.
        firsts: instants of the first hits in ticks; `UNKNOWN` where that is not known.
    """

    items: NDArray[np.int32]
    counts: NDArray[np.int64]
    firsts: NDArray[np.int64]


UNKNOWN = -(1 << 63)
"""In place of an instant that is not known: no instant is so early."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A test with what it hit.

    Attributes:
        digest: distinguishes tests by their content.
        record: the test.
        row: what it hit.
    """

    digest: str
    record: TestRecord
    row: Row


@dataclass(frozen=True, slots=True)
class Coverage:
    """All that a database holds.

    Attributes:
        model: what is to be covered.
        items: names of group and item, in the order of the model.
        entries: the tests, in the order of their campaigns.
        reasons: why an item is not covered, by group and item, in words.
        unreachable: why an item cannot be hit, likewise; it is no goal, and a hit is an error.
    """

    model: Model
    items: Sequence[tuple[str, str]]
    entries: Sequence[Entry]
    reasons: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)
    unreachable: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)

    @property
    def campaigns(self) -> list[str]:
        """The names of the campaigns, in order."""
        return list(dict.fromkeys(entry.record.campaign for entry in self.entries))
