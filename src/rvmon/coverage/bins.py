"""Coverpoints and crosses of a specification, and what runs hit of them, counted by the core."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import product
from struct import iter_unpack

from rvmon.core.plan import pack
from rvmon.coverage.model import Group, Hit, Hits, Item, Subject, combination
from rvmon.logic.formula import Factory
from rvmon.logic.plan import Plan, Watch, WatchGroup, plan_of_watches
from rvmon.logic.state_formula import FALSE
from rvmon.logic.three_valued import Reader
from rvmon.monitor.compiled_spec import Kept
from rvmon.monitor.planned import PlannedCore, planned_as
from rvmon.spec.checked.classify import is_pulse
from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.goals import BinKind, Coverpoint, Cross
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.print.printer import format_formula


class Bins:
    """The bins of a specification, ready to be watched on any number of runs.

    Attributes:
        groups: what may be hit.
    """

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self.groups = [*bin_groups(spec)]

    @cached_property
    def planned(self) -> PlannedCore:
        """What the core counts by.

        Raises:
            RvmonError: a formula is beyond the core.
        """
        return planned_as(self.spec, (), Kept(pack(self.plan).data))

    @cached_property
    def plan(self) -> Plan:
        """Has a watch for each bin, and for each place where some are looked at."""
        points, crosses = self.spec.coverpoints, self.spec.crosses
        reader = Reader(Factory(), self.spec.period)
        watches: list[Watch] = []

        def watch(formula: Formula) -> int:
            # What is not born is false.
            watches.append(Watch(reader.four(formula).read(FALSE), is_pulse(formula)))
            return len(watches) - 1

        axes = {
            name: range(len(watches), 1 + [watch(bin_.formula) for bin_ in point.bins][-1])
            for name, point in points.items()
        }
        asked: list[tuple[tuple[str, ...], Formula | None]]
        asked = [((name,), point.upon) for name, point in points.items()]
        asked += [(cross.points, cross.upon) for cross in crosses.values()]
        groups = [
            WatchGroup(tuple(axes[name] for name in names), None if upon is None else watch(upon))
            for names, upon in asked
        ]
        return plan_of_watches(self.spec, watches, groups)

    def hits(self, counted: bytes) -> Hits:
        """What a run has hit."""
        numbers = iter_unpack("=qq", counted)
        found: dict[str, dict[str, Hit]] = {}
        for group in self.groups:
            for item, (count, first) in zip(group.items, numbers, strict=False):
                if count:
                    found.setdefault(group.name, {})[item] = Hit(count, first)
        return found


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
    items = {
        bin_.name: Item(bin_.name, bin_.kind, point.goal, format_formula(bin_.formula))
        for bin_ in point.bins
    }
    return Group(point.name, Subject.COVERPOINT, items, point.weight)


def _of_cross(cross: Cross, spec: CheckedSpec) -> Group:
    """A combination with a bin that counts for nothing does so itself, as with one that is illegal.

    An illegal bin is reported by its coverpoint.
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
