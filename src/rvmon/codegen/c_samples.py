"""How a compiled monitor takes the updates of an instant: of a sample, or of a row of columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rvmon.codegen.c_leaves import leaf_value
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_nodes import group_count, groups_of
from rvmon.codegen.comment import comment
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import UNKNOWN, Leaf, State, Unborn
from rvmon.plan.numbers import events_of, inputs_of
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, SignalAtom
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Source:
    """Where generated C finds the updates of an instant, as expressions of a number `n`.

    Attributes:
        name: of the function.
        arguments: types and names of what it gets beside the instant.
        signal: what is reported of a signal.
        value: its value, if one is given; of the C type `kind` in a column.
        event: what is reported of an event.
        field: the value of a payload's field.
        chosen: whether the instant is one at which something is known to change.
    """

    name: str
    arguments: tuple[tuple[str, str], ...]
    signal: str
    value: str
    event: str
    field: str
    chosen: bool


SAMPLE = Source(
    name="take",
    arguments=(("const {prefix}_sample *", "sample"),),
    signal="sample->signal[{n}]",
    value="sample->value[{n}]",
    event="sample->event[{n}]",
    field="sample->field[{n}]",
    chosen=False,
)

ROW = Source(
    name="take_row",
    arguments=(("const batch_in *", "in"), ("int64_t ", "row")),
    signal="said(in->value[{n}], in->signal[{n}], row)",
    value="(double)((const {kind} *)in->value[{n}])[row]",
    event="(in->event[{n}] == NULL) ? (uint8_t){prefix}_NOTHING : in->event[{n}][row]",
    field="(in->field[{n}] == NULL) ? unknown_value() : in->field[{n}][row]",
    chosen=True,
)


def take_source(plan: Plan, names: Names, source: Source) -> Iterator[str]:
    """A function that takes the updates of an instant and returns whether something may change."""
    arguments = ", ".join(
        kind.format(prefix=names.prefix) + name for kind, name in source.arguments
    )
    yield ""
    yield f"static bool {source.name}(monitor *m, int64_t t, {arguments})"
    yield "{"
    yield "    bool dirty = false;"
    for name in read_signals(plan):
        yield from (f"    {line}" for line in _take_signal(plan, names, name, source))
    for name in read_events(plan):
        yield from (f"    {line}" for line in _take_event(plan, names, name, source))
    for argument in ("t", "m", *(name for _, name in source.arguments)):
        yield f"    (void){argument};"
    yield "    return dirty;"
    yield "}"


def value_type(plan: Plan, name: str) -> str:
    """The C type of a signal's column."""
    return "uint8_t" if plan.spec.signals[name].type.kind is Kind.BOOL else "double"


def read_signals(plan: Plan) -> list[str]:
    """The signals whose updates matter."""
    signals = plan.spec.signals
    return [
        name for name in plan.signals if name in plan.uses or signals[name].stale_after is not None
    ]


def read_events(plan: Plan) -> list[str]:
    """The events whose occurrences matter."""
    return [name for name in plan.events if name in plan.uses or name == _key(plan)[0]]


def _key(plan: Plan) -> tuple[str, str]:
    """The event and the field whose values tell instances apart; empty: nothing does."""
    for rule in plan.rules:
        if rule.requirement.for_each is not None:
            source = rule.requirement.for_each.value
            return source.event, source.field
    return "", ""


def _captured(plan: Plan) -> frozenset[str]:
    """The signals and events whose values are captured."""
    return inputs_of(*(one.value for rule in plan.rules for one in rule.requirement.captures))


def _has_read_fields(plan: Plan, event: str) -> bool:
    """Whether something reads the payloads of an event."""
    leaves = [state.leaf for state in plan.graph.nodes if isinstance(state.leaf, Compare)]
    sides = [side for leaf in leaves for side in (leaf.left, leaf.right)]
    sides += [one.value for rule in plan.rules for one in rule.requirement.captures]
    return event in events_of(*sides)


def births_asked(plan: Plan) -> dict[str, bool]:
    """The signals of which it is asked whether they are born; of each, whether twice over.

    See `rvmon.formula.state.Unborn`.
    """
    found: dict[str, bool] = {}
    for state in plan.graph.nodes:
        for name, moved in _born_with(state):
            found[name] = found.get(name, False) or moved
    return found


def _born_with(state: State) -> Iterable[tuple[str, bool]]:
    """The signals by whose birth the truth of a leaf changes."""
    match state.leaf:
        case Unborn(signals=signals):
            return signals
        case SignalAtom() | Compare() if state.unborn != UNKNOWN:
            return signals_of(state.leaf).items()
        case _:
            return ()


def is_instant(plan: Plan, name: str, leaf: Leaf | None) -> bool:
    """Whether a leaf depends on the present value of this signal and nothing else."""
    if isinstance(leaf, SignalAtom):
        return True
    return (
        isinstance(leaf, Compare)
        and not plan.uses[name].history
        and inputs_of(leaf.left, leaf.right) == {name}
    )


def _take_signal(plan: Plan, names: Names, name: str, source: Source) -> Iterator[str]:
    prefix = names.prefix
    number = names.signal(name)
    uses = plan.uses.get(name)
    places = plan.graph.by_name.get(name, ())
    stale_after = plan.spec.signals[name].stale_after
    given = source.value.format(n=number, kind=value_type(plan, name))
    yield "{" + f" /* {comment(name)} */"
    yield f"    const uint8_t state = {source.signal.format(n=number)};"
    yield f"    const double value = (state == {prefix}_YES) ? {given} : unknown_value();"
    yield "    const bool known = value == value;"
    yield "    (void)known;"
    ignores = plan.spec.signals[name].ignores_nan
    yield f"    if ({'known' if ignores else f'state != {prefix}_NOTHING'}) {{"
    if name in _captured(plan):
        yield "        dirty = true; /* another value may be captured */"
    if stale_after is not None:
        yield f"        m->stale_at[{number}] = sum(t, INT64_C({stale_after + 1}));"
        # The update may change no value: then nothing else has the timer seen to.
        yield f"        m->alarm = least(m->alarm, m->stale_at[{number}]);"
    if births_asked(plan).get(name):
        births = f"m->births[{number}]"
        yield f"        if (({births} < 2U) && (known || ({births} > 0U))) {{"
        yield f"            {births}++;"
        yield "        }"
    if uses is not None and (uses.history or uses.marked):
        yield f"        m->updated[{number}] = 1;"
        if uses.history:
            yield f"        m->changed[{number}] = either(m->changed[{number}],"
            yield f"            remember(&m->history[{number}], t, value));"
        yield "        m->gathered = true;"
        yield from (f"        {line}" for line in _soil(places))
    if source.chosen and group_count(plan) == 1:
        # All nodes are worked out anyway.
        yield from (f"        {line}" for line in _value(plan, name, number))
        yield from (f"        {line}" for line in _soil(places))
    else:
        yield from (f"        {line}" for line in _change(plan, names, name))
    yield "    }"
    yield "}"


def _change(plan: Plan, names: Names, name: str) -> Iterator[str]:
    """Take a value; only where it differs, and then those leaves only that may differ."""
    number = names.signal(name)
    held = f"m->value[{number}]"
    knowledge, others = [], []
    yield f"if (!same(value, {held})) {{"
    yield f"    const bool learnt = known != ({held} == {held});"
    yield from (f"    {line}" for line in _value(plan, name, number))
    for place in plan.graph.by_name.get(name, ()):
        state = plan.graph.nodes[place]
        if isinstance(state.leaf, Unborn):
            knowledge.append(place)
        elif state.leaf is not None and is_instant(plan, name, state.leaf):
            value = leaf_value(names, state.leaf, state.unborn)
            yield f"    if ({value} != m->truth[{place}]) {{"
            yield from (f"        {line}" for line in _soil([place]))
            yield "    }"
        else:
            others.append(place)
    if knowledge:
        yield "    if (learnt) {"
        yield from (f"        {line}" for line in _soil(knowledge))
        yield "    }"
    yield "    (void)learnt;"
    yield from (f"    {line}" for line in _soil(others))
    yield "}"


def _value(plan: Plan, name: str, number: int) -> Iterator[str]:
    """Hold a value; the first that is known is its birth."""
    yield f"m->value[{number}] = value;"
    if births_asked(plan).get(name) is False:
        yield f"m->births[{number}] |= known ? 1U : 0U;"


def _take_event(plan: Plan, names: Names, name: str, source: Source) -> Iterator[str]:
    prefix = names.prefix
    number = names.event(name)
    places = plan.graph.by_name.get(name, ())
    uses = plan.uses.get(name)
    yield "{" + f" /* {comment(name)} */"
    given = source.event.format(n=number, prefix=prefix)
    if name == _key(plan)[0]:
        key = source.field.format(n=names.field(*_key(plan)))
        yield f"    const uint8_t state = concerning({given}, {key}, m->captured[0]);"
    else:
        yield f"    const uint8_t state = {given};"
    if uses is not None and uses.marked:
        yield f"    if (state != {prefix}_NOTHING) {{"
        yield f"        m->updated[{names.number(name)}] = 1;"
        yield "        m->gathered = true;"
        yield from (f"        {line}" for line in _soil(places))
        yield "    }"
    yield f"    if ((state != {prefix}_NOTHING) && (state != {prefix}_NO)) {{"
    yield f"        const bool known = state == {prefix}_YES;"
    yield "        m->gathered = true;"
    yield f"        m->occurs[{number}] = either(m->occurs[{number}], truth_of(known, true));"
    fields = [names.field(name, field) for field in plan.spec.events[name].fields]
    if fields and _has_read_fields(plan, name):
        upper = prefix.upper()
        yield f"        if (m->payloads[{number}] < {upper}_PAYLOADS) {{"
        yield f"            const int32_t p = m->payloads[{number}];"
        yield f"            m->payload_known[p][{number}] = known ? 1U : 0U;"
        for field in fields:
            yield f"            m->payload[p][{field}] = {source.field.format(n=field)};"
        yield f"            m->payloads[{number}]++;"
        yield "        } else {"
        yield "            HOME(m)->overflow = true;"
        yield "        }"
    yield "        dirty = true;"
    yield from (f"        {line}" for line in _soil(places))
    yield "    }"
    yield "}"


def _soil(places: Iterable[int]) -> Iterator[str]:
    """Have the groups of some nodes worked out at the next position."""
    for group in groups_of(places):
        yield f"m->soiled[{group}] = 1;"
        yield "dirty = true;"
