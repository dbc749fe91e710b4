"""What one value of a sample does, as Python source."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.python_leaves import known_test, leaf_expression
from rvmon.codegen.python_nodes import bits
from rvmon.codegen.python_visit import indented
from rvmon.formula.state import Leaf
from rvmon.plan.numbers import inputs_of
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, SignalAtom
from rvmon.trace.schema import Kind

_CLASSES = {
    Kind.BOOL: "(bool,)",
    Kind.INT: "(int,)",
    Kind.REAL: "(float, int)",
    Kind.LABEL: "(str,)",
}


class ValueWriter:
    """Writes statements that check a value, keep it, and say which nodes may change with it.

    Args:
        plan: what to judge.

    Attributes:
        instant: the leaves that depend on the present value of one signal and nothing else.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.instant = self._instant_leaves()

    def before(self, name: str) -> str:
        """What a value is compared with: the one before."""
        return "False" if name in self.plan.events else f"self.last{self.plan.signals.index(name)}"

    def is_odd(self, variable: str, name: str) -> str:
        """Whether a value needs a closer look: of another class, unknown, or a payload."""
        if name in self.plan.events:
            return f"{variable} is not True"
        type_ = self.plan.spec.signals[name].type
        match type_.kind:
            case Kind.BOOL:
                return f"{variable} is not True and {variable} is not False"
            case Kind.INT:
                return f"{variable}.__class__ is not int"
            case Kind.REAL:
                return (
                    f"({variable}.__class__ is not float or {variable} != {variable}) "
                    f"and {variable}.__class__ is not int"
                )
            case Kind.LABEL:
                return f"{variable}.__class__ is not str or {variable} not in {type_.labels!r}"

    def every(self, variable: str, name: str) -> Iterator[str]:
        """What an update does though the value is the same."""
        uses = self.plan.uses.get(name)
        if name in self.plan.events:
            if uses is not None and uses.marked:
                yield from self._marked_event(name)
            return
        yield from self._on_every_update(variable, name)

    def new(self, variable: str, name: str) -> Iterator[str]:
        """Take a valid value that is not the one before."""
        if name in self.plan.events:
            yield from self._occurs(variable, name)
        else:
            yield from self._changed(variable, name, given=True)

    def taken(self, variable: str, name: str) -> Iterator[str]:
        """Take one value, which may be any that is valid."""
        if name in self.plan.events:
            uses = self.plan.uses.get(name)
            if uses is not None and uses.marked:
                yield from self._marked_event(name)
            yield f"if {variable} is not False:"
            yield from indented(self._occurs(variable, name))
            return
        signal = self.plan.signals.index(name)
        if self.plan.spec.signals[name].ignores_nan:
            yield f"if {variable} is None or {variable} != {variable}:"
            yield "    return dirty"
        else:
            yield f"if {variable} != {variable}:"
            yield f"    {variable} = None"
            yield f"    if self.s[{signal}] is not None:"
            yield f"        self.clerk.lost({name!r}, t, 'nan')"
        yield from self._on_every_update(variable, name)
        yield f"if self.first[{signal}] is None:"
        yield f"    self.first[{signal}] = t"
        yield f"if {variable} is not self.s[{signal}]:"
        yield from indented(self._changed(variable, name, given=False))

    def _changed(self, variable: str, name: str, *, given: bool) -> Iterator[str]:
        """Take another value; `given`: it is not `None`."""
        yield from self.kept(variable, name, given=given)
        others = bits(self.plan.readers(name))
        for place in self.plan.readers(name):
            leaf = self.plan.graph.nodes[place].leaf
            if place in self.instant and leaf is not None and not isinstance(leaf, SignalAtom):
                others &= ~(1 << place)
                test = known_test(leaf, variable) if given else None
                truth = f"2 if {test} else 0" if test else leaf_expression(self.plan, place, leaf)
                yield f"if ({truth}) != self.v[{place}]:"
                yield f"    dirty |= {1 << place}"
        if others:
            yield f"dirty |= {others}"

    def kept(self, variable: str, name: str, *, given: bool) -> Iterator[str]:
        """Keep another value of a signal."""
        signal = self.plan.signals.index(name)
        yield f"if self.s[{signal}] is None:"
        yield f"    self.found({signal}, t)"
        if self.shows_birth(name):
            known = "" if given else f" and {variable} is not None"
            yield f"    if not self.births[{signal}]{known}:"
            yield f"        self.births[{signal}] = 1"
        yield from self._found(name)
        if not given:
            yield f"if {variable} is None:"
            yield f"    self.clerk.lost({name!r}, t, 'none')"
            yield from self._found(name)
        last = variable if given else f"MISSING if {variable} is None else {variable}"
        yield from self.replaced(variable, name, last)

    def replaced(self, variable: str, name: str, last: str) -> Iterator[str]:
        """Keep another value of a signal; if it was known before and is, nothing else is done."""
        signal = self.plan.signals.index(name)
        yield f"self.last{signal} = {last}"
        yield f"self.s[{signal}] = {variable}"

    def shows_birth(self, name: str) -> bool:
        """Whether something depends on when a signal had its first value."""
        uses = self.plan.uses.get(name)
        return uses is not None and uses.birth

    def _found(self, name: str) -> Iterator[str]:
        """What depends on whether the value of a signal is known."""
        knowers = self.plan.knowers(name)
        if knowers:
            yield f"    dirty |= {bits(knowers)}"

    def _occurs(self, variable: str, name: str) -> Iterator[str]:
        yield f"self.occur({self.plan.events.index(name)}, {variable})"
        readers = bits(self.plan.graph.by_name.get(name, ()))
        if readers:
            yield f"dirty |= {readers}"

    def _marked_event(self, name: str) -> Iterator[str]:
        yield f"self.u.add({name!r})"
        yield "self.gathered = True"
        yield f"dirty |= {bits(self.plan.graph.by_name.get(name, ()))}"

    def _on_every_update(self, variable: str, name: str) -> Iterator[str]:
        signal = self.plan.signals.index(name)
        uses = self.plan.uses.get(name)
        if uses is not None and (uses.history or uses.marked):
            yield f"self.mark(t, {signal}, {variable})"
            yield f"dirty |= {bits(self.plan.graph.by_name.get(name, ()))}"
        stale_after = self.plan.spec.signals[name].stale_after
        if stale_after is not None:
            yield f"if self.stale_at[{signal}] < NEVER:"
            yield f"    self.stale_at[{signal}] = t + {stale_after + 1}"
            yield "else:"
            yield f"    self.set_stale({signal}, t + {stale_after + 1})"

    def classes(self, name: str) -> str:
        """The classes of values that need no closer look."""
        if name in self.plan.events:
            return "(bool,)"
        return _CLASSES[self.plan.spec.signals[name].type.kind]

    def labels(self, name: str) -> tuple[str, ...]:
        """The labels that a value has to be one of; empty if it need be none."""
        signal = self.plan.spec.signals.get(name)
        if signal is None or signal.type.kind is not Kind.LABEL:
            return ()
        return tuple(signal.type.labels)

    def _instant_leaves(self) -> frozenset[int]:
        """The leaves that depend on the present value of one signal and nothing else."""
        graph = self.plan.graph
        return frozenset(
            place
            for place, state in enumerate(graph.nodes)
            if state.leaf is not None and self._is_instant(state.leaf)
        )

    def _is_instant(self, leaf: Leaf) -> bool:
        match leaf:
            case SignalAtom():
                return True
            case Compare(left=left, right=right):
                names = inputs_of(left, right)
                if len(names) != 1:
                    return False
                return not self.plan.uses[next(iter(names))].history
            case _:
                return False
