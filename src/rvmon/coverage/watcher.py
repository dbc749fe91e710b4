"""The bins of a specification in generated code, as monitors have the triggers of requirements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from functools import cached_property
from itertools import product

from rvmon.codegen.python_unit import unit_class
from rvmon.coverage.model import Group, Item, Subject, combination
from rvmon.coverage.watched import Watched
from rvmon.formula.alphabet import alphabet_of
from rvmon.formula.factory import Factory
from rvmon.formula.four import Reader
from rvmon.formula.state import FALSE
from rvmon.monitor.online.forms import Forms
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.plan.planning import plan_of
from rvmon.runtime.unit import Unit
from rvmon.runtime.values import NEVER, TRUE
from rvmon.spec.checked.formula import Constant, Formula
from rvmon.spec.checked.goals import BinKind, Coverpoint, Cross
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.spec.checked.tense import is_pulse


class WatchingUnit(Unit):
    """Generated bins, looked at wherever one of them may be hit; it judges nothing.

    Attributes:
        groups: the coverpoints and crosses, each with a bit for each rule that it depends on.
    """

    groups: Sequence[tuple[int, Watched]] = ()
    NOTED = ()
    PULSES: Sequence[tuple[int, int]] = ()
    """Of the rules whose triggers are pulses, the bit and the place of the trigger."""

    def conclude(self, t: int, letters: int, triggers: int) -> None:  # noqa: ARG002 - of none
        """See `Schedule`; a pulse that goes on is another one."""
        self.awaited = NEVER
        changed = triggers | self.repeating
        values = self.v
        for bits, group in self.groups:
            if bits & changed:
                group.look(t, values)
        self.repeating = 0
        for bit, place in self.PULSES:
            if values[place] == TRUE:
                self.repeating |= bit
        if self.gathered:
            self.leave()


class Bins:
    """The bins of a specification, ready to be watched on any number of runs.

    Attributes:
        groups: what may be hit.
        plan: has a rule for each bin, and for each place where some are looked at.
    """

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self.groups = [*bin_groups(spec)]
        asked = {
            (name, bin_.name): bin_.formula
            for name, point in spec.coverpoints.items()
            for bin_ in point.bins
        }
        sampled = {name: point.upon for name, point in spec.coverpoints.items()}
        sampled |= {name: cross.upon for name, cross in spec.crosses.items()}
        asked |= {(name, ""): upon for name, upon in sampled.items() if upon is not None}
        self._numbers = {key: number for number, key in enumerate(asked)}
        self._formulas = asked
        self.plan = _plan_of(spec, [*asked.values()])
        self._forms: dict[frozenset[str] | None, Forms] = {}

    def forms(self, sources: frozenset[str] | None) -> Forms:
        """What is generated to watch runs.

        Args:
            sources: the names that can arrive; `None`: all.
        """
        if sources not in self._forms:
            unit = unit_class(self.plan, sources, WatchingUnit)
            unit.PULSES = tuple((1 << number, self._places[number]) for number in self._pulses)
            self._forms[sources] = Forms((), (), self.plan, unit, ())
        return self._forms[sources]

    def watched(self) -> Iterator[tuple[int, Watched]]:
        """The coverpoints and crosses before a run, each with the bits of its rules."""
        groups = {group.name: group for group in self.groups}
        points = {name: (name,) for name in self.spec.coverpoints}
        for name, own in {**points, **{n: x.points for n, x in self.spec.crosses.items()}}.items():
            axes = [
                [self._numbers[point, bin_.name] for bin_ in self.spec.coverpoints[point].bins]
                for point in own
            ]
            items = dict(zip(product(*axes), groups[name].items, strict=True))
            occasion = self._numbers.get((name, ""))
            made = Watched(name, axes, items, self._places, self._pulses, occasion)
            asked = [occasion] if occasion is not None else [n for axis in axes for n in axis]
            yield sum(1 << number for number in asked), made

    @cached_property
    def _pulses(self) -> Set[int]:
        formulas = self._formulas.values()
        return {number for number, formula in enumerate(formulas) if is_pulse(formula)}

    @cached_property
    def _places(self) -> Sequence[int]:
        index = self.plan.graph.index
        return [index[rule.trigger] for rule in self.plan.rules if rule.trigger is not None]


def _plan_of(spec: CheckedSpec, formulas: Sequence[Formula]) -> Plan:
    """A plan with a rule whose trigger is each of some formulas; nothing is owed."""
    factory = Factory()
    reader = Reader(factory, spec.period)
    nothing = factory.constant(True)
    rules = [
        PlannedRule(
            Requirement(str(number), Mode.UPON, formula, Constant(True), pulse=is_pulse(formula)),
            # What is not born is false.
            reader.four(formula).read(FALSE),
            nothing,
            alphabet_of(nothing),
            None,
        )
        for number, formula in enumerate(formulas)
    ]
    return plan_of(spec, rules)


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
