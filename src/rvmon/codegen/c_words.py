"""Columns for compiled monitors: at which of 64 rows something can change, as the bits of a word.

State formulas that the rows alone decide are worked out for 64 rows at once. What the automata and
timed operators read of them is watched: rows at which none of it changes are passed over.
"""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.c_leaves import TRUTHS, leaf_value
from rvmon.codegen.c_names import Memory, Names, memory_of
from rvmon.codegen.c_samples import births_asked, read_events, read_signals, value_type
from rvmon.formula.state import (
    FALSE,
    TRUE,
    UNKNOWN,
    Leaf,
    Lost,
    State,
    StateOp,
    Unborn,
)
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, Constant, Probe, ProbeAtom, SignalAtom


def words_source(plan: Plan, names: Names) -> Iterator[str]:
    """The functions `is_plain`, `begin_words` and `changes` of the batch source."""
    words = [place for place in range(len(plan.graph.nodes)) if _in_words(plan, place)]
    watched = {place: number for number, place in enumerate(_watched(plan, words))}
    in_row = Names(plan, value="v{}")
    for place in words:
        leaf = plan.graph.nodes[place].leaf
        if leaf is not None and not isinstance(leaf, Constant | Lost):
            yield from _leaf(plan, in_row, place, leaf)
    yield from _birth(plan, names)
    yield ""
    yield f"#define WATCHED_COUNT {len(watched)}"
    yield from _plain(plan, names)
    yield from _beginning(plan, names, watched)
    yield from _changes(plan, names, words, watched)


def _in_words(plan: Plan, place: int) -> bool:
    """Whether the rows up to one decide a state formula there, if each of them has all values."""
    state = plan.graph.nodes[place]
    if state.leaf is not None:
        return _leaf_in_words(plan, state.leaf, place)
    whole = all(_in_words(plan, operand) for operand in plan.graph.operands[place])
    if state.op is StateOp.SINCE:
        return whole and memory_of(state) is Memory.SEEN and _unbroken(plan)
    return whole and state.op in (StateOp.NOT, StateOp.AND, StateOp.OR, StateOp.SURE)


def _unbroken(plan: Plan) -> bool:
    """Whether what rows say is so at all positions from one to the next."""
    signals = plan.spec.signals.values()
    return plan.gap == 1 and all(signal.stale_after is None for signal in signals)


def _leaf_in_words(plan: Plan, leaf: Leaf, place: int) -> bool:
    match leaf:
        case Constant() | SignalAtom() | Lost() | Unborn():
            return True
        case ProbeAtom(probe=probe, name=name):
            return probe is Probe.KNOWN and name in plan.signals
        case Compare():
            names = plan.graph.reads[place].names
            return all(name in plan.signals and not plan.uses[name].history for name in names)
        case _:
            return False


def _watched(plan: Plan, words: list[int]) -> list[int]:
    """The nodes in words of which each change matters elsewhere, or to themselves."""
    graph = plan.graph
    read = {graph.index[state] for rule in plan.rules for state in rule.states}
    return [
        place
        for place in words
        if place in read
        or graph.nodes[place].op is StateOp.SINCE
        or any(parent not in words for parent in graph.parents[place])
    ]


def _leaf(plan: Plan, names: Names, place: int, leaf: Leaf) -> Iterator[str]:
    """A leaf over the columns that it reads; `names` write the value of a column's row."""
    columns = sorted(map(names.signal, plan.graph.reads[place].names))
    absent = {ProbeAtom: FALSE, Unborn: TRUE}
    without = absent.get(type(leaf), plan.graph.nodes[place].unborn)
    given = " && ".join(f"(in->value[{number}] != NULL)" for number in columns)
    yield ""
    yield f"static words leaf{place}(const batch_in *in, int64_t first, int64_t n)"
    yield "{"
    yield f"    words made = all_rows({TRUTHS[without]});"
    yield f"    if ({given}) {{"
    if isinstance(leaf, SignalAtom | Compare | ProbeAtom):
        for number in columns:
            kind = value_type(plan, plan.signals[number])
            yield f"        const {kind} *x{number} = (const {kind} *)in->value[{number}] + first;"
    if isinstance(leaf, Unborn):
        yield "        made = all_rows(IS_FALSE); /* else all rows are taken */"
    elif isinstance(leaf, SignalAtom):
        yield f"        made.is = above(x{columns[0]}, n, 0);"
        yield "        made.may = made.is;"
    else:
        yield from (f"        {line}" for line in _rows(columns, leaf_value(names, leaf)))
    yield "    }"
    yield "    (void)first;"
    yield "    (void)n;"
    yield "    return made;"
    yield "}"


def _birth(plan: Plan, names: Names) -> Iterator[str]:
    yield ""
    yield "/* Whether a row may be the birth of a signal: till then what it is not counts, too. */"
    yield "static bool some_unborn(const monitor *m, const batch_in *in)"
    yield "{"
    yield "    bool found = false;"
    for number in map(names.signal, births_asked(plan)):
        came = f"(in->value[{number}] != NULL)"
        yield f"    found = found || ((m->births[{number}] == 0U) && {came});"
    yield "    (void)m;"
    yield "    (void)in;"
    yield "    return found;"
    yield "}"


def _rows(columns: list[int], text: str) -> Iterator[str]:
    yield "uint8_t is[WORD] = {0};"
    yield "uint8_t may[WORD] = {0};"
    yield "int64_t i;"
    yield "for (i = 0; i < n; i++) {"
    for number in columns:
        yield f"    const double v{number} = (double)x{number}[i];"
    yield f"    const uint8_t truth = {text};"
    yield "    is[i] = (truth == IS_TRUE) ? 1U : 0U;"
    yield "    may[i] = (truth != IS_FALSE) ? 1U : 0U;"
    yield "}"
    yield "made.is = gathered(is);"
    yield "made.may = gathered(may);"


def _plain(plan: Plan, names: Names) -> Iterator[str]:
    """Rows of which each has all values; no update counts for itself."""
    yield ""
    yield "/* Whether values alone say which rows matter. */"
    yield "static bool is_plain(const batch_in *in)"
    yield "{"
    yield f"    bool plain = in->advance == NULL{' && false' if plan.units else ''};"
    for name in read_signals(plan):
        number = names.signal(name)
        uses = plan.uses.get(name)
        yield f"    plain = plain && ((in->value[{number}] == NULL)"
        # What NaN leaves as it was, the row alone does not say.
        ignores = plan.spec.signals[name].ignores_nan
        counts = ignores or (uses is not None and (uses.history or uses.marked))
        other = "false" if counts else f"(in->signal[{number}] == NULL)"
        yield f"                      || {other});"
    yield "    return plain;"
    yield "}"


def _beginning(plan: Plan, names: Names, watched: dict[int, int]) -> Iterator[str]:
    yield ""
    yield "/* What is watched, as it was before the rows that come. */"
    yield "static void begin_words(const monitor *m, words *before)"
    yield "{"
    for place, number in watched.items():
        if plan.graph.nodes[place].op is StateOp.SINCE:
            yield f"    before[{number}] = all_rows(m->seen[{names.memory[place]}]);"
        else:
            yield f"    before[{number}] = all_rows(IS_FALSE);"
    yield "    (void)m;"
    yield "    (void)before;"
    yield "}"


def _changes(plan: Plan, names: Names, words: list[int], watched: dict[int, int]) -> Iterator[str]:
    yield ""
    yield "/* The rows at which something that matters changes, among the `n` from `first` on. */"
    yield "static uint64_t changes(const batch_in *in, int64_t first, int64_t n, words *before)"
    yield "{"
    yield "    uint64_t found = 0;"
    for place in words:
        yield f"    const words w{place} = {_word(plan, place, watched)};"
        if place in watched:
            yield f"    found |= differing(w{place}, &before[{watched[place]}]);"
    for place in words:
        yield f"    (void)w{place};"
    for name in read_events(plan):
        least = "NOTHING" if plan.uses[name].marked else "NO"
        column = f"in->event[{names.event(name)}]"
        yield f"    if ({column} != NULL) {{"
        yield f"        found |= above({column} + first, n, {names.prefix}_{least});"
        yield "    }"
    yield "    (void)in;"
    yield "    (void)first;"
    yield "    (void)n;"
    yield "    (void)before;"
    yield "    return found;"
    yield "}"


def _word(plan: Plan, place: int, watched: dict[int, int]) -> str:
    state: State = plan.graph.nodes[place]
    operands = [f"w{operand}" for operand in plan.graph.operands[place]]
    match state.op:
        case StateOp.NOT:
            return f"not_words({operands[0]})"
        case StateOp.SURE:
            return f"sure_words({operands[0]})"
        case StateOp.AND | StateOp.OR:
            function = "and_words" if state.op is StateOp.AND else "or_words"
            whole = operands[0]
            for operand in operands[1:]:
                whole = f"{function}({whole}, {operand})"
            return whole
        case StateOp.SINCE:
            return f"since_words({operands[0]}, {operands[1]}, before[{watched[place]}])"
        case _ if isinstance(state.leaf, Constant):
            return f"all_rows({TRUTHS[TRUE if state.leaf.value else FALSE]})"
        case _ if isinstance(state.leaf, Lost):
            return f"all_rows({TRUTHS[UNKNOWN]})"
        case _:
            return f"leaf{place}(in, first, n)"
