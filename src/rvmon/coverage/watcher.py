"""The bins of a specification, evaluated as monitors evaluate the formulas of requirements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from rvmon.coverage.model import Group
from rvmon.coverage.of_spec import bin_groups
from rvmon.coverage.watched import Occasion, Watched, WatchedBin
from rvmon.formula.factory import Factory
from rvmon.formula.four import Reader
from rvmon.formula.state import FALSE, State
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.evaluator_classes import generated
from rvmon.plan.graph import graph_of
from rvmon.plan.outages import Outages
from rvmon.plan.planning import uses_of
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.checked.tense import is_pulse


class Watcher(Evaluator):
    """Generated bins, looked at wherever one of them may be hit.

    Attributes:
        groups: the coverpoints and crosses.
    """

    groups: Sequence[Watched] = ()
    _seen = False

    def conclude(self, t: int, letters: int, triggers: int) -> None:
        """See `Schedule`; nothing is judged."""
        self.awaited = NEVER
        # What occurs may do so again where it did before: no value changes with that.
        if letters or triggers or self.fading or not self._seen:
            self._seen = True
            for one in self.groups:
                one.look(t, self.v)
        if self.gathered:
            self.leave()


class Bins:
    """The bins of a specification, ready to be watched on any number of runs.

    Args:
        spec: has them.

    Attributes:
        groups: what may be hit.
    """

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self.groups = [*bin_groups(spec)]
        reader = Reader(Factory(), spec.period)

        def state(formula: Formula) -> State:
            """As a trigger: what is not born is false."""
            return reader.four(formula).read(FALSE)

        bins = {
            name: [(bin_, state(bin_.formula)) for bin_ in point.bins]
            for name, point in spec.coverpoints.items()
        }
        sampled = {name: point.upon for name, point in spec.coverpoints.items()}
        sampled |= {name: cross.upon for name, cross in spec.crosses.items()}
        occasions = {
            name: (upon, state(upon)) for name, upon in sampled.items() if upon is not None
        }
        asked = [found for own in bins.values() for _, found in own]
        graph = graph_of([*asked, *(found for _, found in occasions.values())])
        uses = uses_of([graph], ())
        self._class = generated(spec, graph, uses, uses, Watcher)
        self._axes = {
            name: [WatchedBin(b.name, graph.index[s], is_pulse(b.formula)) for b, s in own]
            for name, own in bins.items()
        }
        self._occasions = {
            name: Occasion(graph.index[found], is_pulse(formula))
            for name, (formula, found) in occasions.items()
        }

    def watcher(self, outages: Outages) -> Watcher:
        """What watches one run.

        Args:
            outages: what is not known at first.
        """
        made = self._class(outages, {})
        made.groups = [*self._watched()]
        return made

    def _watched(self) -> Iterator[Watched]:
        for name in self.spec.coverpoints:
            own = self._axes[name]
            items: dict[tuple[str, ...], str] = {(one.name,): one.name for one in own}
            yield Watched(name, [own], items, self._occasions.get(name))
        groups = {group.name: group for group in self.groups}
        for name, cross in self.spec.crosses.items():
            axes = [self._axes[point] for point in cross.points]
            yield Watched(name, axes, _combinations(groups[name]), self._occasions.get(name))


def _combinations(group: Group) -> Mapping[tuple[str, ...], str]:
    """By combination of bins, the name of its item."""
    return dict(zip(product(*group.axes.values()), group.items, strict=True))
