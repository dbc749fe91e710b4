"""What one run hit, and what several did together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from rvmon.coverage.model import Group, Item, Model
from rvmon.spec.checked.goals import BinKind
from rvmon.verdict.covered import CoveredBin, CoveredGroup


@dataclass(frozen=True, slots=True)
class Hit:
    """How often an item was hit in one run, or in several.

    Attributes:
        count: at least 1.
        first: the instant of the first hit in ticks, where that is known.
    """

    count: int
    first: int | None = None


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

    >>> from rvmon.coverage.model import Subject
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
