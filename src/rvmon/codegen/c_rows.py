"""Columns for compiled monitors: which rows can change something, and rows as samples."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.c_leaves import real
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_samples import (
    ROW,
    is_instant,
    read_events,
    read_signals,
    take_source,
    value_type,
)
from rvmon.codegen.c_text import comment
from rvmon.codegen.plan import Plan
from rvmon.spec.checked import Compare, CompareOp, Literal, SignalValue

_MOST_BITS = 7
_MIRRORED = {
    CompareOp.LT: CompareOp.GT,
    CompareOp.LE: CompareOp.GE,
    CompareOp.EQ: CompareOp.EQ,
    CompareOp.NE: CompareOp.NE,
    CompareOp.GE: CompareOp.LE,
    CompareOp.GT: CompareOp.LT,
}


def rows_source(plan: Plan, names: Names) -> Iterator[str]:
    """The functions `mark_rows`, `refresh` and `take_row` of the batch source."""
    for name in read_signals(plan):
        if not _every(plan, name):
            yield from _code(plan, names, name)
    yield from _marking(plan, names)
    yield from _refreshing(plan, names)
    if read_signals(plan):
        yield from _saying(names)
    yield from take_source(plan, names, ROW)


def _every(plan: Plan, name: str) -> bool:
    """Whether each update of a signal matters, whatever its value."""
    uses = plan.uses.get(name)
    return uses is not None and (uses.history or uses.marked)


def _code(plan: Plan, names: Names, name: str) -> Iterator[str]:
    """A number that changes whenever a leaf that reads this signal may."""
    tests = _tests(plan, name)
    kind = value_type(plan, name)
    number = names.signal(name)
    yield ""
    if kind == "double" and tests is None:
        yield f"static bool differs{number}(double x, double y) /* {comment(name)} */"
        yield "{"
        yield "    return !same(x, y);"
        yield "}"
        return
    yield f"static uint8_t code{number}({kind} now) /* {comment(name)} */"
    yield "{"
    if tests is None or kind == "uint8_t":
        yield "    return now;"
    else:
        bits = " ".join(f"| (unsigned int)(now {t}) << {b}" for b, t in enumerate(tests, 1))
        yield f"    return (uint8_t)((unsigned int)(now != now) {bits});"
    yield "}"
    yield ""
    yield f"static bool differs{number}({kind} x, {kind} y)"
    yield "{"
    yield f"    return code{number}(x) != code{number}(y);"
    yield "}"


def _tests(plan: Plan, name: str) -> list[str] | None:
    """The comparisons with constants that all there is to know of a signal; `None`: it is more."""
    found = []
    for place in plan.graph.by_name.get(name, ()):
        leaf = plan.graph.nodes[place].leaf
        if not isinstance(leaf, Compare) or not is_instant(plan, name, leaf):
            return None
        match leaf.left, leaf.right:
            case SignalValue(), Literal(value=value) if not isinstance(value, str):
                found.append(f"{leaf.op.value} {real(value)}")
            case Literal(value=value), SignalValue() if not isinstance(value, str):
                found.append(f"{_MIRRORED[leaf.op].value} {real(value)}")
            case _:
                return None
    return found if len(found) <= _MOST_BITS else None


def _marking(plan: Plan, names: Names) -> Iterator[str]:
    yield ""
    yield "/* Mark the rows at which something may change; the first has one before it. */"
    yield "static void mark_rows(const batch_in *in, int64_t first, int64_t last, uint8_t *marks)"
    yield "{"
    yield "    int64_t i;"
    for name in read_signals(plan):
        yield from (f"    {line}" for line in _mark_signal(plan, names, name))
    for name in read_events(plan):
        number = names.event(name)
        marked = plan.uses[name].marked
        least = "NOTHING" if marked else "NO"
        yield f"    if (in->event[{number}] != NULL) {{ /* {comment(name)} */"
        yield f"        const uint8_t *x = in->event[{number}];"
        yield "        for (i = first; i < last; i++) {"
        yield f"            marks[i - first] |= (uint8_t)(x[i] > {names.prefix}_{least});"
        yield "        }"
        yield "    }"
    yield "    (void)i;"
    yield "    (void)in;"
    yield "    (void)first;"
    yield "    (void)last;"
    yield "    (void)marks;"
    yield "}"


def _mark_signal(plan: Plan, names: Names, name: str) -> Iterator[str]:
    number = names.signal(name)
    kind = value_type(plan, name)
    every = _every(plan, name)
    perishable = plan.spec.signals[name].stale_after is not None
    yield f"if (in->value[{number}] != NULL) {{ /* {comment(name)} */"
    if not every:
        yield f"    const {kind} *x = in->value[{number}];"
    yield f"    const uint8_t *state = in->signal[{number}];"
    yield "    for (i = first; (state != NULL) && (i < last); i++) {"
    if every or perishable:
        changed = "true"
    else:
        changed = f"(state[i] != state[i - 1]) || differs{number}(x[i], x[i - 1])"
    yield f"        const bool some = state[i] != {names.prefix}_NOTHING;"
    yield f"        marks[i - first] |= (uint8_t)(some && ({changed}));"
    yield "    }"
    yield "    for (i = first; (state == NULL) && (i < last); i++) {"
    changed = "true" if every else f"differs{number}(x[i], x[i - 1])"
    yield f"        marks[i - first] |= (uint8_t){changed};"
    yield "    }"
    yield "}"


def _refreshing(plan: Plan, names: Names) -> Iterator[str]:
    signals = plan.spec.signals
    bounds = {name: signals[name].stale_after for name in plan.signals}
    shortest = min((bound for bound in bounds.values() if bound is not None), default=None)
    yield ""
    yield "/* Rows that are further apart are marked: a signal may be stale between them. */"
    bound = "INT64_MAX" if shortest is None else f"INT64_C({shortest})"
    yield f"#define FARTHEST {bound}"
    yield ""
    yield "/* Note that signals were updated at `t` by rows that were passed over. */"
    yield "static void refresh(monitor *m, const batch_in *in, int64_t t)"
    yield "{"
    for name, bound_of in bounds.items():
        if bound_of is not None:
            number = names.signal(name)
            yield f"    if ((in->value[{number}] != NULL) && (in->signal[{number}] == NULL)) {{"
            yield f"        m->stale_at[{number}] = sum(t, INT64_C({bound_of + 1}));"
            yield "    }"
    yield "    (void)m;"
    yield "    (void)in;"
    yield "    (void)t;"
    yield "}"


def _saying(names: Names) -> Iterator[str]:
    prefix = names.prefix
    yield ""
    yield "/* What a row says of a signal. */"
    yield "static uint8_t said(const void *column, const uint8_t *states, int64_t row)"
    yield "{"
    yield f"    uint8_t state = (uint8_t){prefix}_NOTHING;"
    yield "    if (column != NULL) {"
    yield f"        state = (states == NULL) ? (uint8_t){prefix}_YES : states[row];"
    yield "    }"
    yield "    return state;"
    yield "}"
