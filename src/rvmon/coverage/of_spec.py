"""What a specification asks of runs, as a coverage model: coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from rvmon.coverage.model import Group, Item, Subject, combination
from rvmon.spec.checked.goals import BinKind, Coverpoint, Cross
from rvmon.spec.checked.specification import CheckedSpec


def bin_groups(spec: CheckedSpec) -> Iterator[Group]:
    """The coverpoints and crosses of a specification as groups of a model.

    Args:
        spec: a coverpoint and a cross of it never share a name.
    """
    for point in spec.coverpoints.values():
        yield _of_point(point)
    for cross in spec.crosses.values():
        yield _of_cross(cross, spec)


def _of_point(point: Coverpoint) -> Group:
    items = {bin_.name: Item(bin_.name, bin_.kind, point.goal) for bin_ in point.bins}
    return Group(point.name, Subject.COVERPOINT, items, point.weight)


def _of_cross(cross: Cross, spec: CheckedSpec) -> Group:
    """A combination with a bin that counts for nothing does so itself, as with one that is illegal.

    An illegal bin is told of by its coverpoint.
    """
    points = [spec.coverpoints[name] for name in cross.points]
    items = {}
    for bins in product(*(point.bins for point in points)):
        names = tuple(bin_.name for bin_ in bins)
        kind = BinKind.GOAL
        if names in cross.illegal:
            kind = BinKind.ILLEGAL
        elif names in cross.ignored or any(bin_.kind is not BinKind.GOAL for bin_ in bins):
            kind = BinKind.IGNORE
        name = combination(names)
        items[name] = Item(name, kind, cross.goal)
    axes = {point.name: tuple(bin_.name for bin_ in point.bins) for point in points}
    return Group(cross.name, Subject.CROSS, items, cross.weight, axes)
