"""A plan as C99: a header, a source, and a wrapper for C++."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files

from rvmon.codegen.c_leaves import leaf_value, node_body, uses_library
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_tables import array, automata_source
from rvmon.codegen.plan import Plan
from rvmon.dataflow.numbers import inputs_of
from rvmon.errors import RvmonError
from rvmon.formula.state import Elapsed, State, StateOp
from rvmon.spec.checked import Compare, ProbeAtom, SignalAtom

_PARTS = (
    "monitor_head.c.in",
    "monitor_past.c.in",
    "monitor_tokens.c.in",
    "monitor_attempts.c.in",
    "monitor_clock.c.in",
    "monitor_api.c.in",
)


@dataclass(frozen=True, slots=True)
class CFiles:
    """Generated C by file name."""

    prefix: str
    texts: dict[str, str]


def c_files(plan: Plan) -> CFiles:
    """Generate C.

    Raises:
        RvmonError: a requirement has no automaton.
    """
    for rule in plan.rules:
        if rule.automaton is None:
            raise RvmonError(
                f"{rule.requirement.id} has no automaton of bounded size, so no C can be made of "
                "it: leave it out with --only, or judge it with `rvmon run`"
            )
    return _Writer(plan).files()


class _Writer:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.names = Names(plan)

    def files(self) -> CFiles:
        prefix = self.names.prefix
        places = {  # the first two hold others
            "HELPERS": "\n".join(self._helpers()),
            "TABLES": "\n".join(self._tables()),
            "SPEC": comment(self.plan.spec.name),
            "GUARD": f"{prefix.upper()}_MONITOR_H",
            "HEADER": f"{prefix}.h",
            "PREFIX": prefix.upper(),
            "prefix": prefix,
            "GAP": str(self.plan.gap or 0),
            "NAMES": "\n".join(self._constants()),
            "INCLUDES": "#include <math.h>\n" if uses_library(self.plan) else "",
        }
        source = "".join(template(part) for part in _PARTS)
        if not self._count(StateOp.SINCE):
            source = _without(source, "PAST")
        source = source.replace("@PAST_BEGIN@\n", "").replace("@PAST_END@\n", "")
        if not self._count(StateOp.PREVIOUS):
            source = _without_function(source, "static uint8_t previous(")
        return CFiles(
            prefix,
            {
                f"{prefix}.h": filled(template("monitor.h.in"), places),
                f"{prefix}.c": filled(source, places),
                f"{prefix}.hpp": filled(template("monitor.hpp.in"), places),
                f"{prefix}_batch.c": filled(template("batch.c.in"), places),
            },
        )

    def _count(self, op: StateOp) -> int:
        return sum(state.op is op for state in self.plan.graph.nodes)

    def _constants(self) -> Iterator[str]:
        plan, names = self.plan, self.names
        upper = names.prefix.upper()
        clocks = max((r.automaton.clocks for r in plan.rules if r.automaton), default=0)
        memory = max(self._count(StateOp.SINCE), self._count(StateOp.PREVIOUS))
        sizes = {
            "SIGNALS": len(plan.signals),
            "EVENTS": len(plan.events),
            "NAMES": len(plan.signals) + len(plan.events),
            "FIELDS": len(names.fields),
            "NODES": len(plan.graph.nodes),
            "RULES": len(plan.rules),
            "CLOCKS": clocks,
            "PAST": memory,
        }
        for name, size in sizes.items():
            yield f"#define {upper}_{name} {size}"
            yield f"#define {upper}_{name}_MIN {max(size, 1)}"
        yield f"#define {upper}_TIMED {len(self._timed())}"
        yield f"#define {upper}_PERISHABLE {len(self._perishable())}"
        yield f"#define {upper}_STATEFUL {len(plan.graph.stateful)}"
        for what, listed in (
            ("SIGNAL", plan.signals),
            ("EVENT", plan.events),
            ("RULE", [rule.requirement.id for rule in plan.rules]),
        ):
            yield ""
            for number, name in enumerate(listed):
                yield f"#define {upper}_{what}_{number} {number} /* {comment(name)} */"
        for (event, field), number in names.fields.items():
            yield f"#define {upper}_FIELD_{number} {number} /* {comment(f'{event}.{field}')} */"
        for label, number in names.labels.items():
            yield f"#define {upper}_LABEL_{number} {number} /* {comment(label)} */"

    def _timed(self) -> list[int]:
        return [
            place
            for place, state in enumerate(self.plan.graph.nodes)
            if state.op in (StateOp.SINCE, StateOp.PREVIOUS) or isinstance(state.leaf, Elapsed)
        ]

    def _perishable(self) -> list[int]:
        signals = self.plan.spec.signals
        return [
            number
            for number, name in enumerate(self.plan.signals)
            if signals[name].stale_after is not None
        ]

    def _helpers(self) -> Iterator[str]:
        """Functions of the library of helpers that the nodes call."""
        calls = "\n".join(
            line for place in range(len(self.plan.graph.nodes)) for line in self._body(place)
        )
        calls += "\n".join(self._take())
        if self._count(StateOp.SINCE):
            calls += "sum("
        chosen: list[str] = []
        for block in reversed(template("helpers.c.in").split("\n\n")):
            name = block.split("(", 1)[0].rsplit(" ", 1)[-1]
            if f"{name}(" in calls:
                chosen.append(block)
                calls += block.split("{", 1)[1]
        for block in reversed(chosen):
            yield ""
            yield from block.strip("\n").split("\n")

    def _body(self, place: int) -> list[str]:
        return node_body(self.plan, self.names, place)

    def _tables(self) -> Iterator[str]:
        graph = self.plan.graph
        yield ""
        yield "/* The state formulas. */"
        yield from self._node_functions()
        yield ""
        yield "static uint8_t evaluate(monitor *m, int32_t place, int64_t t)"
        yield "{"
        yield "    uint8_t value = IS_FALSE;"
        yield "    switch (place) {"
        for place in range(len(graph.nodes)):
            body = self._body(place)
            if len(body) > 1:
                yield f"    case {place}: value = node{place}(m, t); break;"
            else:
                text = body[0].removeprefix("return ").removesuffix(";")
                yield f"    case {place}: value = {text}; break;"
        yield "    default: break;"
        yield "    }"
        yield "    (void)t;"
        yield "    return value;"
        yield "}"
        yield from self._take()
        yield from self._index_tables()
        yield from automata_source(self.plan)
        yield from self._letters()

    def _node_functions(self) -> Iterator[str]:
        for place in range(len(self.plan.graph.nodes)):
            body = self._body(place)
            if len(body) > 1:
                yield ""
                yield f"static uint8_t node{place}(monitor *m, int64_t t)"
                yield "{"
                yield from (f"    {line}" for line in body)
                yield "}"

    def _index_tables(self) -> Iterator[str]:
        graph, plan = self.plan.graph, self.plan
        count = len(graph.nodes)
        letters: list[list[int]] = [[] for _ in range(count)]
        triggers: list[list[int]] = [[] for _ in range(count)]
        for index, rule in enumerate(plan.rules):
            for state in rule.alphabet.propositions:
                letters[graph.index[state]].append(index)
            if rule.trigger is not None:
                triggers[graph.index[rule.trigger]].append(index)
        yield ""
        yield from lists("parent_first", "parents", graph.parents)
        yield from lists("letter_first", "letter_of", letters)
        yield from lists("trigger_first", "trigger_of", triggers)
        readers = [graph.by_name.get(name, ()) for name in plan.signals]
        if self._perishable():
            yield from lists("reader_first", "readers", readers)
        else:
            yield "static const int32_t reader_first[] = {0, 0};"
            yield "static const int32_t readers[] = {0};"
        yield from lists("need_first", "needs", self._needs())
        yield array("int32_t", "timed", self._timed())
        yield array("int32_t", "perishable", self._perishable())
        yield array("int32_t", "stateful", graph.stateful)
        momentary = [
            int(place in graph.reads and graph.reads[place].momentary) for place in range(count)
        ]
        yield array("uint8_t", "momentary", momentary)

    def _needs(self) -> list[list[int]]:
        """Per name, the leaves that speak of one position only if it has a source."""
        graph, plan = self.plan.graph, self.plan
        return [
            [
                place
                for place in graph.by_name.get(name, ())
                if graph.reads[place].momentary
                and (name in plan.events or isinstance(graph.nodes[place].leaf, ProbeAtom))
            ]
            for name in (*plan.signals, *plan.events)
        ]

    def _letters(self) -> Iterator[str]:
        graph = self.plan.graph
        places, worse, better = [], [], []
        for rule in self.plan.rules:
            alphabet = rule.alphabet
            places.append([graph.index[state] for state in alphabet.propositions])
            worse.append([weight for weights in alphabet.pessimistic for weight in weights])
            better.append([weight for weights in alphabet.optimistic for weight in weights])
        yield ""
        yield "/* The propositions of each requirement; what false, unknown and true add. */"
        yield from lists("proposition_first", "propositions", places)
        yield array("int32_t", "worse_weights", [w for own in worse for w in own])
        yield array("int32_t", "better_weights", [w for own in better for w in own])
        yield ""
        yield "static void read_letters(const monitor *m, int32_t index, int32_t *worse,"
        yield "                         int32_t *better)"
        yield "{"
        yield "    int32_t i;"
        yield "    *worse = 0;"
        yield "    *better = 0;"
        yield "    for (i = proposition_first[index]; i < proposition_first[index + 1]; i++) {"
        yield "        const int32_t truth = (int32_t)m->truth[propositions[i]];"
        yield "        *worse += worse_weights[3 * i + truth];"
        yield "        *better += better_weights[3 * i + truth];"
        yield "    }"
        yield "}"

    # Samples.

    def _take(self) -> Iterator[str]:
        prefix = self.names.prefix
        yield ""
        yield "/* Take the updates of a sample; tells whether something may have changed. */"
        yield "static void soil(monitor *m, int32_t place);"
        yield f"static bool take(monitor *m, int64_t t, const {prefix}_sample *sample)"
        yield "{"
        yield "    bool dirty = false;"
        for name in self.plan.signals:
            if name in self.plan.graph.by_name or self._keeps(name):
                yield from (f"    {line}" for line in self._take_signal(name))
        for name in self.plan.events:
            if name in self.plan.graph.by_name:
                yield from (f"    {line}" for line in self._take_event(name))
        yield "    (void)t;"
        yield "    (void)m;"
        yield "    (void)sample;"
        yield "    return dirty;"
        yield "}"

    def _keeps(self, name: str) -> bool:
        return self.plan.spec.signals[name].stale_after is not None

    def _take_signal(self, name: str) -> Iterator[str]:
        prefix = self.names.prefix
        number = self.names.signal(name)
        uses = self.plan.uses.get(name)
        places = self.plan.graph.by_name.get(name, ())
        stale_after = self.plan.spec.signals[name].stale_after
        yield f"if (sample->signal[{number}] != {prefix}_NOTHING) {{ /* {comment(name)} */"
        yield f"    const bool known = sample->signal[{number}] == {prefix}_YES;"
        yield f"    const double value = known ? sample->value[{number}] : unknown_value();"
        if stale_after is not None:
            yield f"    m->stale_at[{number}] = sum(t, INT64_C({stale_after + 1}));"
            yield f"    m->alarm = least(m->alarm, m->stale_at[{number}]);"
        if uses is not None and (uses.history or uses.marked):
            yield f"    m->updated[{number}] = 1;"
            if uses.history:
                yield f"    m->changed[{number}] = either(m->changed[{number}],"
                yield f"        remember(&m->history[{number}], t, value));"
            yield "    m->gathered = true;"
            yield from (f"    {line}" for line in _soil(places))
        yield f"    if (!same(value, m->value[{number}])) {{"
        yield f"        m->value[{number}] = value;"
        for place in places:
            state = self.plan.graph.nodes[place]
            if self._is_instant(name, state) and state.leaf is not None:
                yield f"        if ({leaf_value(self.names, state.leaf)} != m->truth[{place}]) {{"
                yield from (f"            {line}" for line in _soil([place]))
                yield "        }"
            else:
                yield from (f"        {line}" for line in _soil([place]))
        yield "    }"
        yield "}"

    def _is_instant(self, name: str, state: State) -> bool:
        if isinstance(state.leaf, SignalAtom):
            return True
        uses = self.plan.uses[name]
        return (
            isinstance(state.leaf, Compare)
            and not uses.history
            and inputs_of(state.leaf.left, state.leaf.right) == {name}
        )

    def _take_event(self, name: str) -> Iterator[str]:
        prefix = self.names.prefix
        number = self.names.event(name)
        places = self.plan.graph.by_name[name]
        yield f"if (sample->event[{number}] != {prefix}_NOTHING) {{ /* {comment(name)} */"
        if self.plan.uses[name].marked:
            yield f"    m->updated[{self.names.number(name)}] = 1;"
            yield "    m->gathered = true;"
            yield from (f"    {line}" for line in _soil(places))
        yield f"    if (sample->event[{number}] != {prefix}_NO) {{"
        yield f"        const bool known = sample->event[{number}] == {prefix}_YES;"
        yield "        m->gathered = true;"
        yield f"        m->occurs[{number}] = either(m->occurs[{number}], truth_of(known, true));"
        fields = [self.names.field(name, field) for field in self.plan.spec.events[name].fields]
        if fields:
            upper = prefix.upper()
            yield f"        if (m->payloads[{number}] < {upper}_PAYLOADS) {{"
            yield f"            const int32_t p = m->payloads[{number}];"
            yield f"            m->payload_known[p][{number}] = known ? 1U : 0U;"
            for field in fields:
                yield f"            m->payload[p][{field}] = sample->field[{field}];"
            yield f"            m->payloads[{number}]++;"
            yield "        } else {"
            yield "            m->overflow = true;"
            yield "        }"
        yield from (f"        {line}" for line in _soil(places))
        yield "    }"
        yield "}"


def _soil(places: Iterable[int]) -> Iterator[str]:
    for place in places:
        yield f"soil(m, {place});"
        yield "dirty = true;"


def lists(first: str, name: str, values: Sequence[Sequence[int]]) -> Iterator[str]:
    """Lists one behind the other, and where each begins."""
    starts = [0]
    for own in values:
        starts.append(starts[-1] + len(own))
    yield array("int32_t", first, starts)
    yield array("int32_t", name, [value for own in values for value in own])


def comment(text: str) -> str:
    """A text that cannot end a comment."""
    return ascii(text)[1:-1].replace("*/", "* /").replace("/*", "/ *").replace("\\", "/")


def template(name: str) -> str:
    """The text of a file of this package's folder `c`."""
    return files("rvmon.codegen").joinpath("c", name).read_text(encoding="utf-8")


def filled(text: str, places: dict[str, str]) -> str:
    """A template with its `@PLACES@` filled, in the order given."""
    for name, part in places.items():
        text = text.replace(f"@{name}@", part)
    return text


def _without(text: str, part: str) -> str:
    before, rest = text.split(f"@{part}_BEGIN@\n", 1)
    return before + rest.split(f"@{part}_END@\n", 1)[1]


def _without_function(text: str, start: str) -> str:
    if start not in text:
        return text
    before, rest = text.split(start, 1)
    return before + rest.split("\n}\n", 1)[1]
