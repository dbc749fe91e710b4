"""A plan as the source of a Python class."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.plan import Plan, PlannedRule
from rvmon.codegen.python_leaves import node_expression
from rvmon.dataflow.numbers import inputs_of
from rvmon.formula.state import StateOp
from rvmon.spec.checked import Compare, Mode, ProbeAtom, SignalAtom
from rvmon.spec.printer import format_formula
from rvmon.trace.schema import Kind

_FEW = 10
"""Up to so many names a sample is taken name by name; above, entry by entry."""


def unit_source(plan: Plan, arriving: frozenset[str] | None = None) -> str:
    """The source of a class `Generated(Unit)`.

    All that comes from the specification stands in it as a literal of `repr`, as a number, or as
    an operator of a fixed list.

    Args:
        plan: what to judge.
        arriving: the names that have a source; default all.
    """
    return "\n".join(_Writer(plan, arriving).lines()) + "\n"


class _Writer:
    def __init__(self, plan: Plan, arriving: frozenset[str] | None) -> None:
        self.plan = plan
        names = [*plan.signals, *plan.events]
        self.arriving = [name for name in names if arriving is None or name in arriving]
        self.instant = self._instant_leaves()

    def lines(self) -> Iterator[str]:
        yield from self._nodes()
        yield "class Generated(Unit):"
        yield f'    """Judges {", ".join(rule.requirement.id for rule in self.plan.rules)}."""'
        yield ""
        yield from (f"    {line}" for line in self._constants())
        yield ""
        yield from (f"    {line}" for line in self._step())
        yield ""
        yield from (f"    {line}" for line in self._take())

    # The state formulas.

    def _nodes(self) -> Iterator[str]:
        for place, state in enumerate(self.plan.graph.nodes):
            expression = node_expression(self.plan, place)
            yield f"def n{place}(self, t):"
            if isinstance(state.leaf, SignalAtom | Compare | ProbeAtom):
                yield f"    # {ascii(format_formula(state.leaf))[1:-1]}"
            for name in ("v", "s"):
                if f"{name}[" in expression:
                    yield f"    {name} = self.{name}"
            yield f"    return {expression}"
            yield ""
            yield ""
        for index, rule in enumerate(self.plan.rules):
            yield f"def letters{index}(v):"
            for name, weights in (
                ("worse", rule.alphabet.pessimistic),
                ("better", rule.alphabet.optimistic),
            ):
                places = [self.plan.graph.index[state] for state in rule.alphabet.propositions]
                terms = [f"{w}[v[{p}]]" for p, w in zip(places, weights, strict=True)]
                yield f"    {name} = {' + '.join(terms) or '0'}"
            yield "    return worse, better"
            yield ""
            yield ""

    def _constants(self) -> Iterator[str]:
        plan, graph = self.plan, self.plan.graph
        count = range(len(graph.nodes))
        letters = [0 for _ in count]
        triggers = [0 for _ in count]
        for index, rule in enumerate(plan.rules):
            for state in rule.alphabet.propositions:
                letters[graph.index[state]] |= 1 << index
            if rule.trigger is not None:
                triggers[graph.index[rule.trigger]] |= 1 << index
        yield f"SIGNALS = {plan.signals!r}"
        yield f"EVENTS = {plan.events!r}"
        yield f"GAP = {plan.gap!r}"
        yield f"NODES = {len(graph.nodes)}"
        yield f"EVALUATE = {_tuple(f'n{place}' for place in count)}"
        yield f"PARENTS = {_tuple(bin(_bits(graph.parents[place])) for place in count)}"
        yield f"LETTERS = {_tuple(bin(bits) for bits in letters)}"
        yield f"TRIGGERS = {_tuple(bin(bits) for bits in triggers)}"
        readers = {name: _bits(places) for name, places in graph.by_name.items()}
        yield f"READERS = { ({name: readers.get(name, 0) for name in plan.signals})!r}"
        yield f"MOMENTARY = {self._momentary()!r}"
        yield f"STATEFUL = {bin(_bits(graph.stateful))}"
        yield f"PAST = {self._past()!r}"
        histories = tuple(index for index, name in enumerate(plan.signals) if self._history(name))
        yield f"HISTORIES = {histories!r}"
        yield "RULES = ("
        for index, rule in enumerate(plan.rules):
            yield f"    (letters{index}, {self._trigger(rule)}),  # {rule.requirement.id}"
        yield ")"

    def _trigger(self, rule: PlannedRule) -> str:
        place = -1 if rule.trigger is None else self.plan.graph.index[rule.trigger]
        requirement = rule.requirement
        return f"{place}, {requirement.pulse!r}, {requirement.mode is Mode.WHENEVER!r}"

    def _momentary(self) -> tuple[tuple[int, tuple[str, ...]], ...]:
        """The leaves that speak of one position, with the names without which they cannot."""
        graph, events = self.plan.graph, self.plan.events
        return tuple(
            (
                place,
                tuple(
                    sorted(
                        name
                        for name in reads.names
                        if name in events or isinstance(graph.nodes[place].leaf, ProbeAtom)
                    )
                ),
            )
            for place, reads in graph.reads.items()
            if reads.momentary
        )

    def _past(self) -> dict[int, tuple[int | None, int | None]]:
        return {
            place: (state.low, state.high) if state.op is StateOp.SINCE else (None, None)
            for place, state in enumerate(self.plan.graph.nodes)
            if state.op in (StateOp.SINCE, StateOp.PREVIOUS)
        }

    def _history(self, name: str) -> bool:
        return name in self.plan.uses and self.plan.uses[name].history

    # Samples.

    def _step(self) -> Iterator[str]:
        yield "def step(self, t, values):"
        yield '    """Take one sample; returns what it decided."""'
        yield "    if t.__class__ is not int or not self.after < t < LIMIT:"
        yield "        return self.clerk.other(t, values)"
        few = len(self.arriving) <= _FEW
        yield from _indented(self._checks_few() if few else self._checks_many())
        yield "    if t > self.wake:"
        yield "        self.through(t - 1)"
        if few:
            yield "    dirty = 0"
            yield "    s = self.s"
            yield "    v = self.v"
            for number, name in enumerate(self.arriving):
                yield from _indented(self._taken(f"x{number}", name))
        else:
            yield "    dirty = 0"
            yield "    for name, x in values.items():"
            yield "        dirty |= self.TAKE[name](self, t, x)"
        yield "    self.after = t"
        yield "    if dirty:"
        yield "        self.dirty |= dirty"
        yield "        self.sampled(t)"
        yield "    elif t >= self.wake:"
        yield "        self.sampled(t)"
        if self.plan.gap is None:
            yield "    self.position = t"
        yield "    if self.news:"
        yield "        return self.clerk.told()"
        yield "    return ()"

    def _checks_few(self) -> Iterator[str]:
        yield "rest = len(values)"
        for number, name in enumerate(self.arriving):
            yield f"x{number} = values.get({name!r}, MISSING)"
            yield f"if x{number} is not MISSING:"
            yield "    rest -= 1"
            yield f"    if {self._is_odd(f'x{number}', name)}:"
            yield "        return self.clerk.other(t, values)"
        yield "if rest:"
        yield "    return self.clerk.other(t, values)"

    def _checks_many(self) -> Iterator[str]:
        yield "for name, x in values.items():"
        yield "    if x.__class__ not in self.CLASSES.get(name, ()) or x != x:"
        yield "        if x.__class__ is not str or x not in self.LABELS.get(name, ()):"
        yield "            return self.clerk.other(t, values)"

    def _is_odd(self, variable: str, name: str) -> str:
        """Whether a value needs a closer look: of another class, unknown, or a payload."""
        if name in self.plan.events:
            return f"{variable} is not True and {variable} is not False"
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

    def _take(self) -> Iterator[str]:
        yield "def take(self, t, values):"
        yield '    """Take the updates of a valid sample; time has come to `t` − 1 before."""'
        yield "    dirty = 0"
        yield "    for name, x in values.items():"
        yield "        dirty |= self.TAKE[name](self, t, x)"
        yield "    self.dirty |= dirty"
        yield "    self.after = t"
        yield "    self.sampled(t)"
        if self.plan.gap is None:
            yield "    self.position = t"
        names = [*self.plan.signals, *self.plan.events]
        for number, name in enumerate(names):
            yield ""
            yield f"def take{number}(self, t, x):"
            yield f"    # {name!r}"
            yield "    dirty = 0"
            yield "    s = self.s"
            yield "    v = self.v"
            yield from _indented(self._taken("x", name, given=True))
            yield "    return dirty"
        yield ""
        yield f"TAKE = {{{', '.join(f'{name!r}: take{n}' for n, name in enumerate(names))}}}"
        if len(self.arriving) > _FEW:
            classes = ", ".join(f"{name!r}: {self._classes(name)}" for name in self.arriving)
            yield f"CLASSES = {{{classes}}}"
            labels = {
                name: self.plan.spec.signals[name].type.labels
                for name in self.arriving
                if name in self.plan.signals
                and self.plan.spec.signals[name].type.kind is Kind.LABEL
            }
            yield f"LABELS = {labels!r}"

    def _classes(self, name: str) -> str:
        if name in self.plan.events:
            return "(bool,)"
        kind = self.plan.spec.signals[name].type.kind
        return {
            Kind.BOOL: "(bool,)",
            Kind.INT: "(int,)",
            Kind.REAL: "(float, int)",
            Kind.LABEL: "()",
        }[kind]

    def _taken(self, variable: str, name: str, *, given: bool = False) -> Iterator[str]:
        """Statements that take one value; `given`: it is there, and may be anything valid."""
        if name in self.plan.events:
            yield from self._taken_event(variable, name, given)
            return
        signal = self.plan.signals.index(name)
        kind = self.plan.spec.signals[name].type.kind
        bits = _bits(self.plan.graph.by_name.get(name, ()))
        if given:
            yield f"if {variable} != {variable}:"
            yield f"    {variable} = None"
        every = self._on_every_update(variable, name, signal, given)
        if every:
            yield "if True:" if given else f"if {variable} is not MISSING:"
            yield from _indented(every)
        differs = (
            f"{variable} is not s[{signal}]" if kind is Kind.BOOL else f"{variable} != s[{signal}]"
        )
        yield f"if {differs}:" if given else f"if {variable} is not MISSING and {differs}:"
        yield f"    if self.first[{signal}] is None:"
        yield f"        self.first[{signal}] = t"
        yield f"    s[{signal}] = {variable}"
        for place in self.plan.graph.by_name.get(name, ()):
            if place in self.instant:
                bits &= ~(1 << place)
                yield f"    if ({node_expression(self.plan, place)}) != v[{place}]:"
                yield f"        dirty |= {bin(1 << place)}"
        if bits:
            yield f"    dirty |= {bin(bits)}"

    def _taken_event(self, variable: str, name: str, given: bool) -> Iterator[str]:
        event = self.plan.events.index(name)
        bits = _bits(self.plan.graph.by_name.get(name, ()))
        indent = ""
        if not given:
            yield f"if {variable} is not MISSING:"
            indent = "    "
        if name in self.plan.uses and self.plan.uses[name].marked:
            yield f"{indent}self.u.add({name!r})"
            yield f"{indent}self.gathered = True"
            yield f"{indent}dirty |= {bin(bits)}"
        yield f"{indent}if {variable} is not False:"
        yield f"{indent}    self.occur({event}, {variable})"
        yield f"{indent}    dirty |= {bin(bits)}"

    def _on_every_update(self, variable: str, name: str, signal: int, given: bool) -> list[str]:
        lines = []
        uses = self.plan.uses.get(name)
        if uses is not None and (uses.history or uses.marked):
            lines.append(f"self.mark(t, {signal}, {variable})")
            lines.append(f"dirty |= {bin(_bits(self.plan.graph.by_name[name]))}")
        stale_after = self.plan.spec.signals[name].stale_after
        if stale_after is not None:
            lines += [
                f"if self.stale_at[{signal}] < NEVER:",
                f"    self.stale_at[{signal}] = t + {stale_after + 1}",
                "else:",
                f"    self.set_stale({signal}, t + {stale_after + 1})",
            ]
        if given:
            lines += [f"if self.first[{signal}] is None:", f"    self.first[{signal}] = t"]
        return lines

    def _instant_leaves(self) -> frozenset[int]:
        """The leaves that depend on the present value of one signal and nothing else."""
        found = set()
        for place, state in enumerate(self.plan.graph.nodes):
            match state.leaf:
                case SignalAtom():
                    found.add(place)
                case Compare(left=left, right=right) if len(inputs_of(left, right)) == 1:
                    name = next(iter(self.plan.graph.reads[place].names))
                    if name in self.plan.signals and not self._history(name):
                        found.add(place)
                case _:
                    pass
        return frozenset(found)


def _bits(places: tuple[int, ...]) -> int:
    return sum(1 << place for place in places)


def _tuple(parts: Iterator[str] | list[str]) -> str:
    return f"({''.join(f'{part}, ' for part in parts)})"


def _indented(lines: Iterator[str] | list[str]) -> Iterator[str]:
    return (f"    {line}" for line in lines)
