"""State formulas as C expressions over the fields of a generated monitor."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import assert_never

from rvmon.codegen.c_names import Memory, Names, memory_of
from rvmon.errors import RvmonError
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import (
    FALSE,
    TRUE,
    UNKNOWN,
    Elapsed,
    Lapsed,
    Leaf,
    Lost,
    State,
    StateOp,
    Unborn,
)
from rvmon.plan.numbers import events_of
from rvmon.plan.plan import Plan
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    BoundAtom,
    Captured,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)

TRUTHS = {FALSE: "(uint8_t)IS_FALSE", UNKNOWN: "(uint8_t)IS_UNKNOWN", TRUE: "(uint8_t)IS_TRUE"}
"""Truth values in C."""


def uses_library(plan: Plan) -> bool:
    """Whether some expression needs `<math.h>`."""
    leaves = (state.leaf for state in plan.graph.nodes)
    compared = (leaf for leaf in leaves if isinstance(leaf, Compare))
    sides = [side for leaf in compared for side in (leaf.left, leaf.right)]
    sides += [capture.value for rule in plan.rules for capture in rule.requirement.captures]
    return any(map(_of_mathematics, sides))


def _of_mathematics(expression: Numeric) -> bool:
    return isinstance(expression, Arithmetic) and (
        expression.op.entry.of_mathematics or any(map(_of_mathematics, expression.args))
    )


def node_statements(names: Names, place: int, state: State) -> list[str]:
    """Statements of a function of `m` and `t` that returns the value of a node.

    There are none where `node_value` gives it.
    """
    if isinstance(state.leaf, Compare) and (events := events_of(state.leaf.left, state.leaf.right)):
        return list(_over_occurrences(names, state.leaf, events, state.unborn))
    if isinstance(state.leaf, Elapsed):
        return [
            f"const int64_t due = sum(m->origin, {_integer(state.leaf.duration)});",
            f"m->wake[{names.timers[place]}] = (t < due) ? due : NEVER;",
            "return truth_of(true, t >= due);",
        ]
    return []


def node_value(names: Names, place: int, state: State, operands: Sequence[str]) -> str:
    """The value of a node as an expression.

    Args:
        names: of the plan.
        place: of the node.
        state: the same as a formula; it takes no statements.
        operands: the truths of its operands.
    """
    if state.leaf is not None:
        return leaf_value(names, state.leaf, state.unborn)
    match state.op:
        case StateOp.NOT:
            return f"(uint8_t)(2U - {operands[0]})"
        case StateOp.AND:
            return _nested("both", operands)
        case StateOp.OR:
            return _nested("either", operands)
        case StateOp.SURE:
            return f"truth_of(true, {operands[0]} == IS_TRUE)"
        case StateOp.DOUBT:
            timer, slot = names.timers[place], names.memory[place]
            how = ", ".join(str(flag).lower() for flag in (state.pulse, state.every))
            return f"doubt(m, {timer}, {slot}, t, m->truth[{place}], {operands[0]}, {how})"
        case StateOp.PREVIOUS:
            return f"previous(m, {names.timers[place]}, {names.memory[place]}, t, {operands[0]})"
        case StateOp.SINCE:
            return _since(names, place, state, ", ".join(operands))
        case StateOp.LEAF:
            raise ValueError("a leaf reads something")
        case _:
            assert_never(state.op)


def _since(names: Names, place: int, state: State, operands: str) -> str:
    slot = names.memory[place]
    memory = memory_of(state)
    if memory is Memory.SEEN:
        return f"since_ever(m, {slot}, {operands})"
    high = "NEVER" if state.high is None else _integer(state.high)
    function = "since_edge" if memory is Memory.EDGE else "since"
    low, timer = _integer(state.low), names.timers[place]
    return f"{function}(m, {timer}, {slot}, t, {operands}, {low}, {high})"


def leaf_value(names: Names, leaf: Leaf, unborn: int = UNKNOWN) -> str:
    """The truth of a leaf that reads no payload; of an atom over signals, `unborn` before birth."""
    if isinstance(leaf, SignalAtom | Compare) and unborn != UNKNOWN and signals_of(leaf):
        seen = _is_unborn(names, signals_of(leaf).items())
        return f"before_birth({leaf_value(names, leaf)}, {seen}, {TRUTHS[unborn]})"
    match leaf:
        case Constant(value=value):
            return TRUTHS[TRUE if value else FALSE]
        case Lapsed():
            return "truth_of(true, t >= m->cut)"
        case Lost():
            return TRUTHS[UNKNOWN]
        case Unborn(signals=signals):
            return f"truth_of(true, {_is_unborn(names, signals)})"
        case Elapsed():
            raise ValueError("elapsed time is looked up by place")
        case BoundAtom():
            return "truth_of(true, t == m->origin)"
        case SignalAtom(name=name):
            held = names.value(name)
            return f"truth_of({held} == {held}, {held} != 0.0)"
        case EventAtom(name=name):
            return f"m->occurs[{names.event(name)}]"
        case ProbeAtom(probe=probe, name=name):
            return _probe(names, probe, name)
        case Compare():
            return _comparison(names, leaf)
        case _:
            assert_never(leaf)


def _is_unborn(names: Names, signals: Iterable[tuple[str, bool]]) -> str:
    """Whether one of some signals is not born; see `rvmon.formula.state.Unborn`."""
    return " || ".join(
        f"(m->births[{names.signal(name)}] <= {int(moved)}U)" for name, moved in signals
    )


def _probe(names: Names, probe: Probe, name: str) -> str:
    match probe:
        case Probe.KNOWN:
            if name in names.plan.signals:
                held = names.value(name)
                return f"truth_of(true, {held} == {held})"
            return f"truth_of(true, m->occurs[{names.event(name)}] != IS_UNKNOWN)"
        case Probe.UPDATED:
            number = names.number(name)
            updated = f"truth_of(true, m->updated[{number}] != 0U)"
            return f"((m->absent[{number}] != 0U) ? (uint8_t)IS_UNKNOWN : {updated})"
        case Probe.CHANGED:
            number = names.number(name)
            return f"((m->absent[{number}] != 0U) ? (uint8_t)IS_UNKNOWN : m->changed[{number}])"
        case _:
            assert_never(probe)


def _comparison(names: Names, leaf: Compare) -> str:
    """A call: each side is worked out once."""
    left, right = number_value(names, leaf.left), number_value(names, leaf.right)
    return f"{leaf.op.c}({left}, {right})"


def _over_occurrences(
    names: Names, leaf: Compare, events: Sequence[str], unborn: int
) -> Iterator[str]:
    numbers = [names.event(event) for event in events]
    yield "uint8_t found = IS_FALSE;"
    for number in numbers:
        yield f"int32_t p{number};"
    absent = " || ".join(f"(m->silent[{number}] == IS_UNKNOWN)" for number in numbers)
    may_occur = " && ".join(
        f"((m->silent[{n}] == IS_UNKNOWN) || (m->payloads[{n}] > 0))" for n in numbers
    )
    yield f"if ({absent}) {{"
    yield f"    return ({may_occur}) ? (uint8_t)IS_UNKNOWN : (uint8_t)IS_FALSE;"
    yield "}"
    for number in numbers:
        yield f"for (p{number} = 0; p{number} < m->payloads[{number}]; p{number}++) {{"
    known = " && ".join(f"(m->payload_known[p{n}][{n}] != 0U)" for n in numbers)
    yield f"    const uint8_t one = ({known}) ? {_comparison(names, leaf)} : (uint8_t)IS_UNKNOWN;"
    yield "    found = either(found, one);"
    for _ in numbers:
        yield "}"
    yield "(void)t;"
    if unborn != UNKNOWN and signals_of(leaf):
        # An occurrence that is unknown leaves it unknown, born or not.
        known = " && ".join(f"all_known(m, {number})" for number in numbers)
        seen = _is_unborn(names, signals_of(leaf).items())
        yield f"if ((found == IS_UNKNOWN) && ({seen}) && {known}) {{"
        yield f"    found = {TRUTHS[unborn]};"
        yield "}"
    yield "return found;"


def number_value(names: Names, expression: Numeric) -> str:
    """The value of a number as an expression."""
    match expression:
        case Literal(value=value):
            return real(names.label(value) if isinstance(value, str) else value)
        case SignalValue(name=name):
            return names.value(name)
        case FieldValue(event=event, field=field):
            return names.payload(event, field)
        case UpdateValue(function=function, name=name):
            return _update(names, function, name)
        case Arithmetic(op=op, args=args):
            return _arithmetic(op, [number_value(names, arg) for arg in args])
        case Captured(name=name):
            return names.captured(name)
        case _:
            assert_never(expression)


def _update(names: Names, function: UpdateFunction, name: str) -> str:
    return f"{function.value}_of(&m->history[{names.signal(name)}], {names.value(name)})"


def _arithmetic(op: NumericOp, args: list[str]) -> str:
    whole, *rest = args
    for arg in rest or ("",):
        whole = op.entry.c.format(whole, arg)
    return f"finite_only({whole})"


def _nested(function: str, args: Sequence[str]) -> str:
    whole = args[0]
    for arg in args[1:]:
        whole = f"{function}({whole}, {arg})"
    return whole


def real(value: float) -> str:
    """A number as a C literal of type double, exactly.

    Raises:
        RvmonError: there is no such double.
    """
    number = float(value)
    if number != value:
        raise RvmonError(
            f"the whole number {value} has more digits than the doubles of generated code: "
            "evaluate the specification with `rvmon run`, or write another bound"
        )
    if not math.isfinite(number):
        raise ValueError(f"{value} is no number of a specification")
    text = repr(number)
    return f"({text})" if number < 0 else text


def _integer(value: int) -> str:
    return f"INT64_C({value})"
