"""A plan as C99: a header, a source, and a wrapper for C++."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

from rvmon.codegen.c_leaves import uses_library
from rvmon.codegen.c_names import Memory, Names, memory_of
from rvmon.codegen.c_network import Networks
from rvmon.codegen.c_nodes import (
    UNDETERMINED,
    group_count,
    group_of,
    groups_of,
    guards_of,
    momentary_counts,
    needs,
    nodes_source,
)
from rvmon.codegen.c_rows import rows_source
from rvmon.codegen.c_samples import SAMPLE, take_source
from rvmon.codegen.c_tables import array, automata_source, lists, repeats, runs_on
from rvmon.codegen.c_text import called, filled, template
from rvmon.codegen.comment import comment
from rvmon.errors import RvmonError
from rvmon.formula.state import StateOp
from rvmon.plan.plan import Plan

_LIBRARY = ("helpers.c.in", "monitor_past.c.in")
"""Functions of which a source has those that it calls."""

_PARTS = (
    "monitor_head.c.in",
    "monitor_tokens.c.in",
    "monitor_attempts.c.in",
    "monitor_drive.c.in",
    "monitor_clock.c.in",
    "monitor_api.c.in",
)

_NETWORK = tuple(
    f"network_{part}.c.in" for part in ("ranges", "known", "nodes", "state", "attempts", "judge")
)
"""What stands behind the attempts where a network judges some of them."""


@dataclass(frozen=True, slots=True)
class CFiles:
    """Generated C by file name."""

    prefix: str
    texts: dict[str, str]


def c_files(plan: Plan) -> CFiles:
    """Generate C.

    Raises:
        RvmonError: there is no requirement, or a number of the specification is no double.
    """
    if not plan.rules:
        raise RvmonError("the specification has no requirements: there is nothing to compile")
    return _Writer(plan).files()


class _Writer:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.names = Names(plan)
        self.networks = Networks(plan)

    def files(self) -> CFiles:
        prefix = self.names.prefix
        places = {  # the first ones hold others
            "HELPERS": "\n".join(self._helpers()),
            "TABLES": "\n".join(self._tables()),
            "NETWORK_TABLES": "\n".join(self.networks.tables()),
            "ROWS": "\n".join(rows_source(self.plan, self.names)),
            "HEAP": template("heap.c.in"),
            "WIDEN": template("widen.c.in"),
            "SPEC": comment(self.plan.spec.name),
            "GUARD": f"{prefix.upper()}_MONITOR_H",
            "HEADER": f"{prefix}.h",
            "PREFIX": prefix.upper(),
            "prefix": prefix,
            "GAP": str(self.plan.gap or 0),
            "REPEATING": str(int(any(map(repeats, self.plan.rules)))),
            "EPISODES": str(int(any(map(runs_on, self.plan.rules)))),
            "NAMES": "\n".join(self._constants()),
            "INCLUDES": "#include <math.h>\n" if uses_library(self.plan) else "",
        }
        behind = _PARTS.index("monitor_attempts.c.in") + 1
        network = _NETWORK if self.networks.number else ()
        source = "".join(map(template, (*_PARTS[:behind], *network, *_PARTS[behind:])))
        return CFiles(
            prefix,
            {
                f"{prefix}.h": filled(template("monitor.h.in"), places),
                f"{prefix}.c": filled(source, places),
                f"{prefix}.hpp": filled(template("monitor.hpp.in"), places),
                f"{prefix}_batch.c": filled(template("batch.c.in"), places),
            },
        )

    def _constants(self) -> Iterator[str]:
        plan, names = self.plan, self.names
        upper = names.prefix.upper()
        clocks = max((r.automaton.clocks for _, r in plan.judges if r.automaton), default=0)
        sizes = {
            "SIGNALS": len(plan.signals),
            "EVENTS": len(plan.events),
            "NAMES": len(plan.signals) + len(plan.events),
            "FIELDS": len(names.fields),
            "NODES": len(plan.graph.nodes),
            "RULES": len(plan.rules),
            "JUDGES": len(plan.judges),
            "CLOCKS": clocks,
            "GROUPS": group_count(plan),
            "TIMED": len(names.timers),
            **{kind.name: names.memories(kind) for kind in Memory},
            **self.networks.sizes,
        }
        for name, size in sizes.items():
            yield f"#define {upper}_{name} {size}"
            yield f"#define {upper}_{name}_MIN {max(size, 1)}"
        yield f"#define {upper}_PERISHABLE {len(self._perishable())}"
        yield f"#define {upper}_STATEFUL {len(self._stateful())}"
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

    def _perishable(self) -> list[int]:
        signals = self.plan.spec.signals
        return [
            number
            for number, name in enumerate(self.plan.signals)
            if signals[name].stale_after is not None
        ]

    def _stateful(self) -> list[int]:
        """The groups that have to be worked out at each sample, if only these are positions."""
        nodes = self.plan.graph.nodes
        lasting = [
            place
            for place in self.plan.graph.stateful
            if nodes[place].op is not StateOp.DOUBT
            and not (nodes[place].op is StateOp.SINCE and memory_of(nodes[place]) is Memory.SEEN)
        ]
        return groups_of(lasting)

    def _undetermined_timers(self) -> list[int]:
        guards = guards_of(self.plan)
        return [n for place, n in self.names.timers.items() if guards.get(place) == UNDETERMINED]

    def _helpers(self) -> Iterator[str]:
        """Functions of the library of helpers that the nodes call."""
        calls = "\n".join((*nodes_source(self.plan, self.names), *self._taking()))
        return called(calls, "\n".join(template(part) for part in _LIBRARY))

    def _taking(self) -> Iterator[str]:
        return take_source(self.plan, self.names, SAMPLE)

    def _tables(self) -> Iterator[str]:
        yield ""
        yield "/* The state formulas. */"
        yield from nodes_source(self.plan, self.names)
        yield from self._taking()
        yield from self._index_tables()
        yield from automata_source(self.plan, self.networks.number)
        yield from self._letters()

    def _index_tables(self) -> Iterator[str]:
        """Timers and what else makes groups of nodes be worked out anew."""
        graph, plan = self.plan.graph, self.plan
        readers = [groups_of(graph.by_name.get(name, ())) for name in plan.signals]
        yield ""
        if self._perishable():
            yield from lists("reader_first", "readers", readers)
        else:
            yield "static const int32_t reader_first[] = {0, 0};"
            yield "static const int32_t readers[] = {0};"
        yield from lists("need_first", "needs", needs(plan))
        counts = Counter(map(group_of, self.names.timers))
        ends = accumulate(counts[group] for group in range(group_count(plan)))
        yield array("int32_t", "timed_first", [0, *ends])
        yield array("int32_t", "perishable", self._perishable())
        yield array("int32_t", "stateful", self._stateful())
        yield array("int32_t", "undetermined_timers", self._undetermined_timers())
        yield f"#define UNDETERMINED_TIMERS {len(self._undetermined_timers())}"
        # Counted down for each name without a source; at 0 the leaf stays as it is.
        yield array("uint8_t", "momentary", momentary_counts(plan))

    def _letters(self) -> Iterator[str]:
        graph = self.plan.graph
        places: list[list[int]] = []
        worse, better = [], []
        for _, rule in self.plan.judges:
            alphabet = rule.alphabet
            if rule.automaton is None:  # a network reads each proposition by itself
                places.append([])
                continue
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
