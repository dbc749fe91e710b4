"""A plan as C99: a header, a source, and a wrapper for C++."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from rvmon.codegen.c_leaves import node_body, uses_library
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_rows import rows_source
from rvmon.codegen.c_samples import take_source
from rvmon.codegen.c_tables import array, automata_source, lists
from rvmon.codegen.c_text import comment, filled, template, without, without_function
from rvmon.codegen.plan import Plan
from rvmon.errors import RvmonError
from rvmon.formula.state import Elapsed, StateOp
from rvmon.spec.checked import ProbeAtom

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
        places = {  # the first three hold others
            "HELPERS": "\n".join(self._helpers()),
            "TABLES": "\n".join(self._tables()),
            "ROWS": "\n".join(rows_source(self.plan, self.names)),
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
            source = without(source, "PAST")
        source = source.replace("@PAST_BEGIN@\n", "").replace("@PAST_END@\n", "")
        if not self._count(StateOp.PREVIOUS):
            source = without_function(source, "static uint8_t previous(")
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
        calls += "\n".join(take_source(self.plan, self.names))
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
        yield from take_source(self.plan, self.names)
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
        # Counted down for each name without a source; at 0 the leaf stays as it is.
        named = Counter(place for places in self._needs() for place in places)
        momentary = [
            max(named[place], int(graph.reads[place].momentary)) if place in graph.reads else 0
            for place in range(count)
        ]
        yield array("uint8_t", "momentary", momentary)

    def _needs(self) -> list[list[int]]:
        """Per name, the leaves that speak of one position if that or another one has a source."""
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
