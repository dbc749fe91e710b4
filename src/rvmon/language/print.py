"""Prints checked formulas and numbers in the language, with as few brackets as possible."""

from __future__ import annotations

from decimal import Decimal
from typing import assert_never

from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.operators import PREFIXED, Window
from rvmon.language.checked.rewrite import chain, without_spans
from rvmon.language.syntax.keywords import RESERVED
from rvmon.trace.time import TICKS_PER_UNIT

_SUM, _PRODUCT, _NEGATIVE, _OPERAND = 0, 1, 2, 3
_ARITHMETIC = {
    NumericOp.ADD: _SUM,
    NumericOp.SUB: _SUM,
    NumericOp.MUL: _PRODUCT,
    NumericOp.DIV: _PRODUCT,
    NumericOp.NEG: _NEGATIVE,
}


def format_formula(formula: rv.Formula) -> str:
    """The text of a checked formula in the language.

    >>> released, window = rv.EventAtom("released"), rv.Interval(0, 3 * 10**9)
    >>> format_formula(rv.Unary(rv.UnaryOp.EVENTUALLY, released, window))
    'within 3 s released'
    """
    return _formula(formula, 0)


def format_numeric(numeric: rv.Numeric) -> str:
    """The text of a checked number or label in the language.

    >>> parts = rv.SignalValue("x"), rv.Literal(0.5, "m")
    >>> format_numeric(rv.Arithmetic(NumericOp.SUB, parts))
    'x - 0.5 m'
    """
    return _numeric(numeric, _SUM)


def format_duration(ticks: int) -> str:
    """The text of a duration in ticks, in the largest unit that gives a whole number.

    >>> [format_duration(ticks) for ticks in (3 * 10**9, 200_000_000, 90 * 10**9, 7, 0)]
    ['3 s', '200 ms', '90 s', '7 ns', '0 s']
    """
    if ticks == 0:
        return "0 s"
    unit, size = max(
        ((unit, size) for unit, size in TICKS_PER_UNIT.items() if ticks % size == 0),
        key=lambda pair: pair[1],
    )
    return f"{ticks // size} {unit}"


def _formula(formula: rv.Formula, level: int) -> str:
    """The formula, in brackets if it binds more loosely than `level`."""
    match formula:
        case rv.Constant(value=value):
            return "true" if value else "false"
        case rv.SignalAtom(name=name) | rv.EventAtom(name=name):
            return _name(name)
        case rv.ProbeAtom(probe=probe, name=name):
            return f"{probe}({_name(name)})"
        case rv.BoundAtom(bound=bound):
            return str(bound)
        # A bool that is not a signal, such as a payload field, is compared with `true`.
        case rv.Compare(left=left, right=rv.Literal(value=bool())):
            return format_numeric(left)
        case rv.Compare(op=op, left=left, right=right):
            return f"{format_numeric(left)} {op} {format_numeric(right)}"
        case rv.Amount():
            return _amount(formula, denied=False)
        case rv.Unary(op=rv.UnaryOp.NOT, operand=rv.Amount() as denied):
            return _amount(denied, denied=True)
        case rv.Unary(op=rv.UnaryOp.NOT, operand=one):
            return _age(one, denied=True) or _unary(formula)
        case rv.Unary():
            return _age(formula, denied=False) or _unary(formula)
        case rv.Passed(since=since, after=after, strict=strict):
            start = "" if since is None else f" - {_name(since)}"
            return f"now{start} {'>' if strict else '>='} {format_numeric(after)}"
        case rv.Binary(op=op):
            text = _binary(formula)
            return f"({text})" if op.entry.level < level else text
        case _:
            assert_never(formula)


def _age(formula: rv.Formula, *, denied: bool) -> str:
    """The text of a limit on an age, or of its negation; "" for any other formula."""
    match formula:
        case rv.Unary(
            op=rv.UnaryOp.ONCE,
            operand=rv.Binary(
                op=rv.BinaryOp.OR,
                left=rv.ProbeAtom(probe=rv.Probe.UPDATED, name=name),
                right=rv.BoundAtom(bound=rv.Bound.START),
            ),
            interval=rv.Interval(low=0, high=int() as high),
        ):
            # The checker turned `age(x) < 200 ms` into "at most 199999999 ns". The shorter text is
            # the original one.
            most = (rv.CompareOp.LE, format_duration(high))
            below = (rv.CompareOp.LT, format_duration(high + 1))
            op, limit = min(most, below, key=lambda one: len(one[1]))
            return f"age({_name(name)}) {op.denied if denied else op} {limit}"
        case _:
            return ""


def _amount(formula: rv.Amount, *, denied: bool) -> str:
    limit = format_numeric(formula.limit)
    if formula.of.measured is rv.Measured.DURATION and isinstance(formula.limit, rv.Literal):
        limit = format_duration(int(formula.limit.value))
    op = rv.CompareOp.GT if formula.strict else rv.CompareOp.GE
    return f"{format_window(formula.of)} {op.denied if denied else op} {limit}"


def format_window(formula: rv.WindowValue) -> str:
    """The text of a window in the language.

    >>> format_window(rv.WindowValue(rv.Measured.COUNT, rv.EventAtom("e"), 5 * 10**9))
    'count(e, 5 s)'
    """
    word, what = str(formula.measured), ""
    conditions = _conditions(formula)
    since = rv.since_trigger() in conditions
    conditions = [condition for condition in conditions if condition != rv.since_trigger()]
    if formula.value is None and formula.counted is not None:
        what = _formula(formula.counted, 0)
    elif formula.value is None or isinstance(formula.value, rv.Literal):  # the integral of 1
        word = "duration" if formula.measured.of_time else word
        what = " and ".join(
            _formula(condition, 0 if len(conditions) == 1 else 4) for condition in conditions
        )
    else:
        what = format_numeric(formula.value)
        if conditions and formula.most is None:
            condition = " and ".join(_formula(condition, 4) for condition in conditions)
            what = f"if {condition} then {what} else 0"
    if formula.most is not None:
        what = f"last({formula.most}, {what})"
    if since:
        what = f"({what}) since trigger" if " " in what else f"{what} since trigger"
    window = "" if formula.window is None else f", {format_duration(formula.window)}"
    return f"{word}({what}{window})"


def _conditions(formula: rv.WindowValue) -> list[rv.Formula]:
    """The conditions on a member that were written in the specification.

    The checker adds two that are left out: that the number is known, and that the signal of the
    number is updated.
    """
    conditions = [without_spans(one) for one in chain(formula.operand)]
    if formula.value is not None and not isinstance(formula.value, rv.Literal):
        conditions = [
            condition for condition in conditions if condition != rv.itself(formula.value)
        ]
        if isinstance(formula.value, rv.SignalValue):
            updated = rv.ProbeAtom(rv.Probe.UPDATED, formula.value.name)
            conditions = [condition for condition in conditions if condition != updated]
    if formula.value is None and len(conditions) > 1 and rv.since_trigger() not in conditions:
        return [formula.operand]
    return [*conditions, *formula.chosen]


def _unary(formula: rv.Unary) -> str:
    op = formula.op
    if not op.entry.called:
        return f"{_operator(op, formula.interval)} {_formula(formula.operand, PREFIXED)}"
    length = ""
    if op.entry.window is Window.LENGTH:
        length = f", {format_duration((formula.interval or rv.Interval()).high or 0)}"
    return f"{op.entry.word}({_formula(formula.operand, 0)}{length})"


def _operator(op: rv.UnaryOp, interval: rv.Interval | None) -> str:
    if interval is not None and interval.low == 0 and interval.high is not None:
        if op is rv.UnaryOp.EVENTUALLY:
            return f"within {format_duration(interval.high)}"
        if op is rv.UnaryOp.ALWAYS:
            return f"for {format_duration(interval.high)}"
    return op.entry.word + _window(interval)


def _window(interval: rv.Interval | None) -> str:
    if interval is None or interval == rv.Interval():
        return ""
    low = format_duration(interval.low) if interval.low else "0"
    if interval.high is None:
        return f"[{low}, inf)"
    return f"[{low}, {format_duration(interval.high)}]"


def _binary(formula: rv.Binary) -> str:
    op = formula.op
    level = op.entry.level
    if op.entry.chained:
        operands = chain(formula, op)
        texts = [_left(operand, level + 1) for operand in operands[:-1]]
        texts.append(_formula(operands[-1], level + 1))
        # The parser requires brackets here (RV002) except beside `<->`, which binds loosest.
        if op is not rv.BinaryOp.IFF:
            for place, one in enumerate(operands):
                if isinstance(one, rv.Binary) and one.op.is_kin_of_until:
                    texts[place] = f"({texts[place]})"
        return f" {op.entry.word} ".join(texts)
    right = formula.right
    same = isinstance(right, rv.Binary) and right.op is op
    right_level = level if same else level + 1
    left = _left(formula.left, level + 1)
    return f"{left} {op.entry.word}{_window(formula.interval)} {_formula(right, right_level)}"


def _left(formula: rv.Formula, level: int) -> str:
    """A left operand, bracketed also if it ends in the operand of a temporal prefix.

    Without brackets the prefix could be read as reaching over the connective (RV002).
    """
    edge = formula  # the rightmost operand that is printed without brackets
    while True:
        match edge:
            case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
                edge = operand
            case rv.Binary(op=op, right=right) if op.entry.level >= level:
                edge = right
            case _:
                break
    prefixed = isinstance(edge, rv.Unary) and not edge.op.entry.called
    return f"({_formula(formula, 0)})" if prefixed else _formula(formula, level)


def _numeric(numeric: rv.Numeric, level: int) -> str:
    match numeric:
        case rv.Literal():
            return _literal(numeric, level)
        case rv.NowValue():
            return "now"
        case rv.SignalValue(name=name) | rv.Captured(name=name):
            return _name(name)
        case rv.FieldValue(event=event, field=field):
            return _name(f"{event}.{field}")
        case rv.WindowValue():
            return format_window(numeric)
        case rv.UpdateValue(function=function, name=name):
            return f"{function}({_name(name)})"
        case rv.Arithmetic():
            binding = _ARITHMETIC.get(numeric.op, _OPERAND)
            text = _arithmetic(numeric)
            return f"({text})" if binding < level else text
        case _:
            assert_never(numeric)


def _arithmetic(numeric: rv.Arithmetic) -> str:
    match numeric.op:
        case NumericOp.ADD | NumericOp.SUB:
            left, right = numeric.args
            return f"{_numeric(left, _SUM)} {numeric.op} {_numeric(right, _PRODUCT)}"
        case NumericOp.MUL | NumericOp.DIV:
            left, right = numeric.args
            return f"{_numeric(left, _PRODUCT)} {numeric.op} {_numeric(right, _NEGATIVE)}"
        case NumericOp.NEG:
            return f"-{_numeric(numeric.args[0], _NEGATIVE)}"
        case op:
            written = numeric.args[: op.entry.most]  # the checker appends a full turn for angles
            return f"{op}({', '.join(_numeric(arg, _SUM) for arg in written)})"


def _literal(literal: rv.Literal, level: int) -> str:
    if isinstance(literal.value, str):
        return _name(literal.value)
    text = format(Decimal(repr(literal.value)).normalize(), "f")
    if len(text) > 20:
        text = repr(literal.value)
    if literal.unit.startswith("1/"):  # a number cannot have this unit, but a quotient can
        text = f"{text} / 1 {literal.unit[2:].replace('/', '*')}"
        return f"({text})" if level > _PRODUCT else text
    if literal.unit:
        text = f"{text} {literal.unit}"
    return f"({text})" if literal.value < 0 and level > _NEGATIVE else text


def _name(name: str) -> str:
    """A name, in backticks if it would otherwise be read as something else."""
    plain = all(part.isidentifier() for part in name.split("."))
    return name if plain and name not in RESERVED else f"`{name}`"
