"""A plan as C99: a header, a source, and a wrapper for C++."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
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
from rvmon.codegen.c_units import Unit
from rvmon.codegen.comment import comment
from rvmon.errors import RvmonError
from rvmon.formula.state import StateOp
from rvmon.plan.plan import Plan

_LIBRARY = ("helpers.c.in", "monitor_past.c.in")
"""Functions of which a source has those that it calls."""

_BEGIN = ("monitor_head.c.in", "monitor_tokens.c.in")
_DRIVE = ("monitor_drive.c.in", "monitor_clock.c.in", "monitor_run.c.in")
_UNIT = ("unit_monitors.c.in", "unit_keys.c.in", "unit_api.c.in")

_NETWORK = (
    "formulas.c.in",
    *(
        f"network_{part}.c.in"
        for part in ("ranges", "known", "nodes", "state", "attempts", "judge")
    ),
)
"""What stands behind the attempts where a network judges some of them."""


_SHARED = {"APART": 0, "EACH": 0, "PAST_SAMPLES": 0}
"""Of what has no captured values."""


@dataclass(frozen=True, slots=True)
class CFiles:
    """Generated C by file name.

    Attributes:
        prefix: what all identifiers start with.
        texts: the files.
        units: those of them that are compiled beside the source of that name.
    """

    prefix: str
    texts: dict[str, str]
    units: tuple[str, ...] = ()


def c_files(plan: Plan) -> CFiles:
    """Generate C.

    Raises:
        RvmonError: there is no requirement, or a number of the specification is no double.
    """
    if not plan.asked:
        raise RvmonError("the specification has no requirements: there is nothing to compile")
    return _Whole(plan).files()


class _Writer:
    """Of one source: of a unit, or of all else.

    Args:
        plan: what is generated.
        prefix: what all identifiers start with.
        main: the same of the source of the whole.
        numbers: of the requirements of its rules, among all.
    """

    def __init__(self, plan: Plan, prefix: str, main: str, numbers: Sequence[int]) -> None:
        self.plan = plan
        self.names = Names(plan, prefix=prefix)
        self.networks = Networks(plan)
        self.prefix = prefix
        self.numbers = numbers
        self.unit = Unit(plan) if any(rule.is_apart for rule in plan.rules) else None
        self._main = main

    @property
    def places(self) -> dict[str, str]:
        """What templates are filled with; the first ones hold others."""
        return {
            "HELPERS": "\n".join(self._helpers()),
            "TABLES": "\n".join(self._tables()),
            "NETWORK_TABLES": "\n".join(self.networks.tables()),
            "SPEC": comment(self.plan.spec.name),
            "GUARD": f"{self.prefix.upper()}_MONITOR_H",
            "HEADER": f"{self._main}.h",
            "PREFIX": self.prefix.upper(),
            "prefix": self.prefix,
            "MAIN": self._main.upper(),
            "main": self._main,
            "GAP": str(self.plan.gap or 0),
            "REPEATING": str(int(any(map(repeats, self.plan.rules)))),
            "EPISODES": str(int(any(map(runs_on, self.plan.rules)))),
            "NAMES": "\n".join(self.constants()),
            "INCLUDES": "#include <math.h>\n" if uses_library(self.plan) else "",
        }

    @property
    def source(self) -> str:
        """The text of the source."""
        network = _NETWORK if self.networks.number else ()
        first: tuple[str, ...] = ()
        last: tuple[str, ...] = ("monitor_api.c.in",)
        if self.unit is not None:
            first, last = ("unit_attempts.c.in",), _UNIT
        parts = (*_BEGIN, *first, "monitor_attempts.c.in", *network, *_DRIVE, *last)
        return filled("".join(map(template, parts)), self.places)

    @property
    def types(self) -> str:
        """What the header says of a unit."""
        number = f"#define {self.prefix.upper()}_REQUIREMENT {self.numbers[0]}"
        places = {
            "STATE": template("monitor_state.h.in"),
            "UNIT_FIELDS": "",
            "ID": comment(self.plan.rules[0].requirement.id),
            **self.places,
        }
        return f"{number}\n{filled(template('unit.h.in'), places)}"

    def constants(self) -> Iterator[str]:
        """Sizes, as the header has them."""
        plan, names = self.plan, self.names
        upper = self.prefix.upper()
        clocks = max((r.automaton.clocks for _, r in plan.judges if r.automaton), default=0)
        sizes = {
            "SIGNALS": len(plan.signals),
            "EVENTS": len(plan.events),
            "NAMES": len(plan.signals) + len(plan.events),
            "FIELDS": len(names.fields),
            "NODES": len(plan.graph.nodes),
            "RULES_HERE": len(plan.rules),
            "RULES": len(plan.asked),
            "UNITS": len(plan.units),
            "JUDGES": len(plan.judges),
            "CLOCKS": clocks,
            "GROUPS": group_count(plan),
            "TIMED": len(names.timers),
            **{kind.name: names.memories(kind) for kind in Memory},
            **self.networks.sizes,
            **(_SHARED if self.unit is None else self.unit.sizes),
        }
        for name, size in sizes.items():
            yield f"#define {upper}_{name} {size}"
            yield f"#define {upper}_{name}_MIN {max(size, 1)}"
        yield f"#define {upper}_PERISHABLE {len(self._perishable())}"
        yield f"#define {upper}_STATEFUL {len(self._stateful())}"

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
        own = () if self.unit is None else self.unit.source(self.names)
        calls = "\n".join((*nodes_source(self.plan, self.names), *self._taking(), *own))
        return called(calls, "\n".join(template(part) for part in _LIBRARY))

    def _taking(self) -> Iterator[str]:
        return take_source(self.plan, self.names, SAMPLE)

    def _tables(self) -> Iterator[str]:
        yield ""
        yield "/* The state formulas. */"
        yield from nodes_source(self.plan, self.names)
        yield from self._taking()
        yield from self._index_tables()
        yield from automata_source(self.plan, self.networks.number, self.numbers)
        yield from self._letters()
        if self.unit is not None:
            yield ""
            yield from self.unit.source(self.names)

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


class _Whole:
    """All sources of a plan."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        prefix = Names(plan).prefix
        number = {id(rule): place for place, rule in enumerate(plan.asked)}

        def writer(own: Plan, name: str) -> _Writer:
            return _Writer(own, name, prefix, [number[id(rule)] for rule in own.rules])

        self.main = writer(plan, prefix)
        self.units = [writer(one, f"{prefix}_{n}") for n, one in enumerate(plan.units, start=1)]

    def files(self) -> CFiles:
        """Their texts."""
        prefix = self.main.prefix
        fields = [f"    {one.prefix}_home unit{n};\n" for n, one in enumerate(self.units, start=1)]
        places = {  # the first ones hold others
            "STATE": template("monitor_state.h.in"),
            "UNIT_TYPES": "".join(unit.types for unit in self.units),
            "UNIT_FIELDS": "".join(fields),
            "ROWS": "\n".join(rows_source(self.plan, self.main.names)),
            "HEAP": template("heap.c.in"),
            **self.main.places,
            "NAMES": "\n".join((*self.main.constants(), *self._names())),
        }
        texts = {
            f"{prefix}.h": filled(template("monitor.h.in"), places),
            f"{prefix}.c": self.main.source,
            f"{prefix}.hpp": filled(template("monitor.hpp.in"), places),
            f"{prefix}_batch.c": filled(template("batch.c.in"), places),
        }
        units = {f"{unit.prefix}.c": unit.source for unit in self.units}
        return CFiles(prefix, texts | units, tuple(units))

    def _names(self) -> Iterator[str]:
        plan, names = self.plan, self.main.names
        upper = names.prefix.upper()
        units = range(1, len(plan.units) + 1)
        yield f"#define {upper}_EACH_UNIT(DO) {' '.join(f'DO({n})' for n in units)}".rstrip()
        captured = max((len(rule.captured) for rule in plan.asked), default=0)
        yield f"#define {upper}_CAPTURED {captured}"
        for what, listed in (
            ("SIGNAL", plan.signals),
            ("EVENT", plan.events),
            ("RULE", [rule.requirement.id for rule in plan.asked]),
        ):
            yield ""
            for number, name in enumerate(listed):
                yield f"#define {upper}_{what}_{number} {number} /* {comment(name)} */"
        for (event, field), number in names.fields.items():
            yield f"#define {upper}_FIELD_{number} {number} /* {comment(f'{event}.{field}')} */"
        for label, number in names.labels.items():
            yield f"#define {upper}_LABEL_{number} {number} /* {comment(label)} */"
