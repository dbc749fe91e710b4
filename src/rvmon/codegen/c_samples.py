"""How a compiled monitor takes the updates of a sample."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rvmon.codegen.c_leaves import leaf_value
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_text import comment
from rvmon.codegen.plan import Plan
from rvmon.dataflow.numbers import inputs_of
from rvmon.formula.state import Leaf
from rvmon.spec.checked import Compare, SignalAtom


def take_source(plan: Plan, names: Names) -> Iterator[str]:
    """The function `take` of the source."""
    yield ""
    yield "/* Take the updates of a sample; tells whether something may have changed. */"
    yield "static void soil(monitor *m, int32_t place);"
    yield f"static bool take(monitor *m, int64_t t, const {names.prefix}_sample *sample)"
    yield "{"
    yield "    bool dirty = false;"
    for name in read_signals(plan):
        yield from (f"    {line}" for line in _take_signal(plan, names, name))
    for name in read_events(plan):
        yield from (f"    {line}" for line in _take_event(plan, names, name))
    yield "    (void)t;"
    yield "    (void)m;"
    yield "    (void)sample;"
    yield "    return dirty;"
    yield "}"


def read_signals(plan: Plan) -> list[str]:
    """The signals whose updates matter."""
    signals = plan.spec.signals
    return [
        name
        for name in plan.signals
        if name in plan.graph.by_name or signals[name].stale_after is not None
    ]


def read_events(plan: Plan) -> list[str]:
    """The events whose occurrences matter."""
    return [name for name in plan.events if name in plan.graph.by_name]


def is_instant(plan: Plan, name: str, leaf: Leaf | None) -> bool:
    """Whether a leaf depends on the present value of this signal and nothing else."""
    if isinstance(leaf, SignalAtom):
        return True
    return (
        isinstance(leaf, Compare)
        and not plan.uses[name].history
        and inputs_of(leaf.left, leaf.right) == {name}
    )


def _take_signal(plan: Plan, names: Names, name: str) -> Iterator[str]:
    prefix = names.prefix
    number = names.signal(name)
    uses = plan.uses.get(name)
    places = plan.graph.by_name.get(name, ())
    stale_after = plan.spec.signals[name].stale_after
    yield f"if (sample->signal[{number}] != {prefix}_NOTHING) {{ /* {comment(name)} */"
    yield f"    const bool known = sample->signal[{number}] == {prefix}_YES;"
    yield f"    const double value = known ? sample->value[{number}] : unknown_value();"
    if stale_after is not None:
        yield f"    m->stale_at[{number}] = sum(t, INT64_C({stale_after + 1}));"
        # The update may change no value: then nothing else has the timer seen to.
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
        leaf = plan.graph.nodes[place].leaf
        if leaf is not None and is_instant(plan, name, leaf):
            yield f"        if ({leaf_value(names, leaf)} != m->truth[{place}]) {{"
            yield from (f"            {line}" for line in _soil([place]))
            yield "        }"
        else:
            yield from (f"        {line}" for line in _soil([place]))
    yield "    }"
    yield "}"


def _take_event(plan: Plan, names: Names, name: str) -> Iterator[str]:
    prefix = names.prefix
    number = names.event(name)
    places = plan.graph.by_name[name]
    yield f"if (sample->event[{number}] != {prefix}_NOTHING) {{ /* {comment(name)} */"
    if plan.uses[name].marked:
        yield f"    m->updated[{names.number(name)}] = 1;"
        yield "    m->gathered = true;"
        yield from (f"    {line}" for line in _soil(places))
    yield f"    if (sample->event[{number}] != {prefix}_NO) {{"
    yield f"        const bool known = sample->event[{number}] == {prefix}_YES;"
    yield "        m->gathered = true;"
    yield f"        m->occurs[{number}] = either(m->occurs[{number}], truth_of(known, true));"
    fields = [names.field(name, field) for field in plan.spec.events[name].fields]
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
