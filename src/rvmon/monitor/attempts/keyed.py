"""The instances of one `for each`: which are open, whom a sample concerns, which are over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.instance import Instance, values_in
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.instances import reach_of
from rvmon.spec.checked.specification import ForEach
from rvmon.trace.sample import Scalar, Value

MOST_OPEN = 50_000
"""So many instances of one requirement can be open at once."""

MOST_KNOWN = 10_000
"""So many values that are over are remembered, the latest."""


class Keyed:
    """The instances of a requirement in one run.

    Args:
        compiled: the requirement.
        each: of it.
        template: the evaluator of the instance of no value.
        instance: that instance.
        is_timed: whether only what changes is looked at; else each sample concerns all.

    Attributes:
        known: the values that occurred, but for those that were forgotten.
        open: the evaluators of those that are not over.
        reach: what they depend on.
        sees_all: whether each sample concerns all that are open.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        each: ForEach,
        template: Evaluator,
        instance: Instance,
        *,
        is_timed: bool,
    ) -> None:
        self.compiled = compiled
        self.each = each
        self.template = template
        self.doubted = instance
        self.known: dict[Scalar, Instance] = {}
        self.open: dict[Scalar, Evaluator] = {}
        self.reach = reach_of(
            compiled.shared_graph,
            each,
            compiled.obligation.trigger,
            looks_back=compiled.network_plan.looks_back,
        )
        self._last_rank = 0
        self._over: dict[Scalar, None] = {}
        self.sees_all = not is_timed or bool(compiled.requirement.captures)

    def instances(self) -> list[Instance]:
        """Those that are known, first those that are over, in the order in which they were."""
        return [self.known[value] for value in (*self._over, *self.open)]

    def take(self, found: Iterable[Instance]) -> None:
        """Know the instances of another run; none of them is open."""
        for one in found:
            self.known[one.value] = one
            self._over[one.value] = None
            self._last_rank = max(self._last_rank, one.rank)

    def values_to_open(self, values: Mapping[str, Value]) -> list[Scalar]:
        """The values of which a sample asks for the instance, and that have no evaluator.

        An occurrence of unknown value may be of any that is known.
        """
        occurring = dict.fromkeys(values_in(self.each.value, values))
        if None in occurring:
            occurring |= self._over
        return [one for one in occurring if one is not None and one not in self.open]

    def opened(self, value: Scalar, evaluator: Evaluator) -> None:
        """Take the evaluator of an instance."""
        self._over.pop(value, None)
        self.open[value] = evaluator

    def instance(self, value: Scalar, t: int) -> Instance:
        """The instance of a value that occurs at `t`."""
        found = self.known.get(value)
        if found is None:
            self._last_rank += 1
            found = self.known[value] = Instance(self._last_rank, self.each.value, value, t)
        return found

    def concerned(self, values: Mapping[str, Value]) -> list[Scalar]:
        """The open instances that a sample concerns."""
        if self.sees_all or not self.reach.others.isdisjoint(values):
            return list(self.open)
        found: dict[Scalar, None] = {}
        for event, field in self.reach.fields.items():
            if event in values:
                found.update(dict.fromkeys(values_in(field, values)))
        return list(self.open) if None in found else [one for one in found if one in self.open]

    def is_over(self, evaluator: Evaluator) -> bool:
        """Whether an instance stands as one would that is made anew when its value occurs next."""
        return (
            self.reach.begins
            and self.reach.is_fresh
            and evaluator.is_quiet
            and evaluator.stands_like(self.template, self.reach.varying)
        )

    def close(self, value: Scalar) -> None:
        """Let go of an instance that is over; its value is remembered for a while."""
        del self.open[value]
        self._over[value] = None
        if len(self._over) > MOST_KNOWN:
            oldest = next(iter(self._over))
            del self._over[oldest], self.known[oldest]
