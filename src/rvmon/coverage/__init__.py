"""Coverage as data: models of items with goals, hits, and records of tests.

The other modules collect hits, store them in databases, and analyse them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from enum import StrEnum
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar

from msgspec import Struct, field
from msgspec.structs import replace

from rvmon.language.checked.properties import BinKind
from rvmon.verdicts import Verdict
from rvmon.verdicts.run_coverage import CoveredBin, CoveredGroup, IllegalHit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

STATES = "states"
TRANSITIONS = "transitions"
PAIRS = "pairs of transitions"
"""Names of the groups for a system's states; items of the last two are states joined by arrows."""


class Subject(StrEnum):
    """The kind of the items of a group."""

    COVERPOINT = "coverpoint"
    CROSS = "cross"
    GOAL = "cover goal"
    REQUIREMENT = "requirement"
    STATES = "states"
    TRANSITIONS = "transitions"
    STATEMENTS = "statements"
    BRANCHES = "branches"


class Item(Struct, frozen=True):
    """One coverage item: a bin, a combination of bins, a state, a line and so on."""

    name: str  # unique in its group
    kind: BinKind = BinKind.GOAL  # goal, ignored, or illegal (a hit is an error)
    goal: int = 1  # the number of hits it needs
    text: str = ""  # a description: a condition, a line of code; "" if the name suffices


class Group(Struct, frozen=True):
    """The items of one subject."""

    name: str  # unique in its model
    subject: Subject  # the kind of its items
    items: Mapping[str, Item]  # by name, in order
    weight: int = 1  # its weight in the total; with 0 it is shown, but not counted
    # For a cross: the bins of each of its coverpoints, by the coverpoint's name. The items of a
    # cross are named by `combination`.
    axes: Mapping[str, Sequence[str]] = field(default_factory=dict)
    title: str = ""  # a description, such as the text of a requirement


class Model(Struct, frozen=True):
    """A coverage model: all groups of items, by name."""

    groups: Mapping[str, Group]

    def goals_of(self, group: str) -> list[tuple[str, str]]:
        """The goals of a group, as names of group and item; none if there is no such group."""
        items = self.groups[group].items if group in self.groups else {}
        return [(group, item.name) for item in items.values() if item.kind is BinKind.GOAL]


def combination(bins: Sequence[str]) -> str:
    """The name of the item of a cross with one bin of each axis, in the order of the axes.

    >>> combination(["yes", "touch"]), combination(["yes", "a × b"])
    ('yes × touch', 'yes × `a × b`')
    """
    return " × ".join(f"`{one}`" if "×" in one else one for one in bins)


def group_of(
    name: str, subject: Subject, items: Sequence[Item], weight: int = 1, title: str = ""
) -> Group:
    """A group without axes.

    Raises:
        ValueError: two items have the same name.
    """
    named = {item.name: item for item in items}
    if len(named) < len(items):
        raise ValueError(f"two items of `{name}` have the same name")
    return Group(name, subject, named, weight, title=title)


def model_of(groups: Sequence[Group]) -> Model:
    """A model of some groups.

    Raises:
        ValueError: two groups have the same name.

    >>> gaze = group_of("gaze", Subject.COVERPOINT, [Item("yes"), Item("no", goal=3)])
    >>> [*model_of([gaze]).groups]
    ['gaze']
    """
    named = {group.name: group for group in groups}
    if len(named) < len(groups):
        double = next(group.name for group in groups if named[group.name] is not group)
        raise ValueError(f"two groups have the same name, `{double}`")
    return Model(named)


def without(model: Model, items: Collection[tuple[str, str]]) -> Model:
    """The model with some items ignored, which are given by group and name.

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


class Hit(Struct, frozen=True):
    """The hits of an item in one run, or in several."""

    count: int  # at least 1
    first: int | None = None  # the instant of the first hit, ticks, if known

    def __reduce__(self) -> tuple[type[Hit], tuple[int, int | None]]:
        # A compact pickle: thousands of tests send a hundred hits each between processes.
        return Hit, (self.count, self.first)


Hits = Mapping[str, Mapping[str, Hit]]
"""Hits by group and item, without items that were not hit. All must be in the model."""


class Score(Struct, frozen=True):
    """The coverage of a group."""

    items: int  # the number of items that are goals
    covered: int  # the number of these that reached their goals


def merged(several: Iterable[Hits]) -> dict[str, dict[str, Hit]]:
    """The hits of several runs together: counts are added, first instants are dropped.

    >>> one = {"gaze": {"yes": Hit(2, 5)}}
    >>> merged([one, {"gaze": {"yes": Hit(1, 3), "no": Hit(1)}}])["gaze"]["yes"].count
    3
    """
    total: dict[str, dict[str, Hit]] = {}
    for hits in several:
        for group, items in hits.items():
            group_hits = total.setdefault(group, {})
            for item, hit in items.items():
                known = group_hits[item].count if item in group_hits else 0
                group_hits[item] = Hit(known + hit.count)
    return total


def count_of(hits: Hits, group: str, item: str) -> int:
    """The number of hits of an item."""
    hit = hits.get(group, {}).get(item)
    return 0 if hit is None else hit.count


def score(hits: Hits, group: Group) -> Score:
    """The coverage of a group; ignored and illegal items are not goals."""
    wanted = [item for item in group.items.values() if item.kind is BinKind.GOAL]
    covered = sum(count_of(hits, group.name, item.name) >= item.goal for item in wanted)
    return Score(len(wanted), covered)


def share(hits: Hits, model: Model) -> float:
    """The covered share of a model; see `weighted`.

    Returns:
        From 0 to 1; exactly 0 or 1 only if nothing or everything is covered; 1 without goals.
    """
    return weighted((group, score(hits, group)) for group in model.groups.values())


def weighted(scores: Iterable[tuple[Group, Score]]) -> float:
    """The mean over subjects of the weighted means of their groups, rounded once.

    So a cross counts the same regardless of the number of requirements. Groups without goals or
    weight are left out.

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
        # Fractions, as thirds in floats may add up to 1 with a goal open, or to more than 1.
        sum(Fraction(weight * one.covered, one.items) for weight, one in scored)
        / sum(weight for weight, _ in scored)
        for scored in subjects.values()
    ]
    return float(sum(means) / len(means)) if means else 1.0


def illegal(hits: Hits, model: Model) -> list[IllegalHit]:
    """The illegal items that were hit."""
    return [
        IllegalHit(group.name, item.name, hit.count, hit.first or 0)
        for group in model.groups.values()
        for item in group.items.values()
        if item.kind is BinKind.ILLEGAL and (hit := hits.get(group.name, {}).get(item.name))
    ]


def covered_groups(hits: Hits, model: Model) -> tuple[CoveredGroup, ...]:
    """The coverage of one run by group, including items that were not hit."""
    found = []
    for group in model.groups.values():
        own = hits.get(group.name, {})
        bins = []
        for item in group.items.values():
            hit = own.get(item.name)
            count, first = (0, None) if hit is None else (hit.count, hit.first)
            bins.append(CoveredBin(item.name, item.kind, item.goal, count, first))
        found.append(CoveredGroup(group.name, group.subject.value, tuple(bins)))
    return tuple(found)


class Ending(StrEnum):
    """The ways in which a test ends."""

    COMPLETED = "completed"
    CRASHED = "crashed"
    HUNG = "hung"
    LOST = "lost"


class TestRecord(Struct, frozen=True):
    """A test of a campaign with its result, without its hits."""

    __test__: ClassVar[bool] = False  # keeps pytest from collecting it by its name

    name: str  # its display name; need not be unique
    campaign: str = ""  # the name of its campaign
    strategy: str = ""  # that generated it; "" if none did, as for a recording from the field
    recording: str = ""  # path of the recording; "" if it was not kept
    seed: int | None = None  # the seed to replay it with
    system: str = ""  # the system under test, such as a robot and its version
    verdicts: Mapping[str, Verdict] = field(default_factory=dict)  # by requirement
    ending: Ending = Ending.COMPLETED  # of the test
    error: str = ""  # the error, if it did not complete
    number: int = 0  # its position in the campaign; ties are ordered by `when`
    seconds: float = 0.0  # its duration in seconds
    when: int | None = None  # time of recording, ns since 1970 UTC; `None`: when it is stored
    expected: Mapping[str, str] = field(default_factory=dict)  # known failures, each with a reason
    origin: int = 0  # the first instant of its run in ticks, which is shown as 0 s

    @property
    def failed(self) -> tuple[str, ...]:
        """The requirements that failed unexpectedly."""
        return tuple(name for name in self._failed if name not in self.expected)

    @property
    def failed_as_expected(self) -> dict[str, str]:
        """The requirements that failed as expected, each with the reason."""
        return {name: self.expected[name] for name in self._failed if name in self.expected}

    @property
    def _failed(self) -> list[str]:
        return [name for name, verdict in self.verdicts.items() if verdict is Verdict.FAIL]


class Row(Struct, frozen=True, eq=False):
    """The hits of a test, as parallel columns."""

    items: NDArray[np.int32]  # int32[n], the hit items as indices of `Coverage.items`, ascending
    counts: NDArray[np.int64]  # int64[n], numbers of hits, at least 1
    firsts: NDArray[np.int64]  # int64[n], instants of the first hits in ticks, or `UNKNOWN`


UNKNOWN = -(1 << 63)  # stands for an unknown instant; earlier than all instants


class Entry(Struct, frozen=True):
    """A test with its hits."""

    digest: str  # a hash that identifies the test by its content
    record: TestRecord  # the test
    row: Row  # its hits


class Coverage(Struct, frozen=True):
    """The contents of a coverage database."""

    model: Model  # the model
    items: Sequence[tuple[str, str]]  # names of group and item, in the order of the model
    entries: Sequence[Entry]  # the tests, in the order of their campaigns
    # Reasons why items are not covered, by group and item.
    reasons: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)
    # Reasons why items cannot be hit, by group and item. Such an item is not a goal, and a hit
    # contradicts the reason.
    unreachable: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)

    @property
    def campaigns(self) -> list[str]:
        """The names of the campaigns, in order."""
        return list(dict.fromkeys(entry.record.campaign for entry in self.entries))
