"""Columns for compiled monitors: rows as updates, and which of them are passed over."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.c_names import Names
from rvmon.codegen.c_samples import ROW, read_signals, take_source, value_type
from rvmon.codegen.c_text import called, template
from rvmon.codegen.c_words import words_source
from rvmon.plan.plan import Plan


def rows_source(plan: Plan, names: Names) -> Iterator[str]:
    """The functions of the batch source that depend on the specification."""
    own = list(words_source(plan, names))
    yield from called("\n".join(own), template("words.c.in"))
    yield from own
    yield from _refreshing(plan, names)
    if read_signals(plan) or plan.units:
        yield from _saying(names)
    if plan.units:
        yield from _values(plan)
    yield from take_source(plan, names, ROW)


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


def _values(plan: Plan) -> Iterator[str]:
    yield ""
    yield "static double column_value(const batch_in *in, int32_t signal, int64_t row)"
    yield "{"
    yield "    switch (signal) {"
    for number, name in enumerate(plan.signals):
        kind = value_type(plan, name)
        yield f"    case {number}: return (double)((const {kind} *)in->value[{number}])[row];"
    yield "    default: return unknown_value();"
    yield "    }"
    yield "}"
