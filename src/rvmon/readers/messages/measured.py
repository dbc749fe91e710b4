"""In which unit a value is that is calculated of fields, and whether that is the declared one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce

from rvmon.errors import TraceError
from rvmon.readers.messages.meaning import Sort, meaning_of
from rvmon.readers.messages.topic import Topic
from rvmon.trace.schema import Applied, Bound, Constant, Elements, Field, Schema, Term
from rvmon.units import PLAIN, Unit, parse_unit

_ALIKE = frozenset({"+", "-", "min", "max", "hypot", "<", "<=", ">", ">=", "==", "!="})
"""Operations whose arguments are in one unit."""

_TRUTHS = frozenset({"<", "<=", ">", ">=", "==", "!=", "and", "or", "xor", "not", "any", "all"})


@dataclass(frozen=True, slots=True)
class Measure:
    """A unit of a value.

    Attributes:
        unit: of it, at least of the same kind.
        is_exact: whether the scale is known as well.
    """

    unit: Unit
    is_exact: bool = True


def measures_of(term: Term, topic: Topic) -> tuple[Measure, ...]:
    """In which units a value may be; none if nobody knows, or if it is a constant.

    Raises:
        TraceError: the units of what is added or compared contradict each other.
    """
    match term:
        case Constant():
            return ()
        case Field() | Elements():
            meaning = meaning_of(str(term), topic)
            if meaning.sort is Sort.QUATERNION:
                return (Measure(PLAIN),)
            return tuple(Measure(unit, not meaning.is_scaled) for unit in meaning.units)
        case Applied(sign="yaw"):
            return (Measure(parse_unit("rad")),)
        case Applied(args=(value, _), sign=""):
            return measures_of(value, topic)
        case Applied(args=args, sign=sign):
            inner = [measures_of(arg, topic) for arg in args]
            if sign in _ALIKE:
                _expect_alike(term, inner, topic)
            return () if sign in _TRUTHS else _combined(sign, args, inner)


def _combined(
    sign: str, args: tuple[Term, ...], inner: list[tuple[Measure, ...]]
) -> tuple[Measure, ...]:
    """The units of a result, where those of all arguments but constants are known."""
    known = [(arg, own) for arg, own in zip(args, inner, strict=True) if own]
    if any(not own and not isinstance(arg, Constant) for arg, own in zip(args, inner, strict=True)):
        return ()
    if not known or (sign in ("*", "/") and len(known) == 2) or sign == "sqrt":
        return ()  # products of fields are rare: that nothing is known of them does no harm
    if sign == "/" and not inner[0]:
        return ()
    # A number that is not a field may change the scale: thousandths of metres become metres.
    return tuple(Measure(one.unit, one.is_exact and sign not in ("*", "/")) for one in known[0][1])


def _expect_alike(term: Applied, inner: list[tuple[Measure, ...]], topic: Topic) -> None:
    dimensions = [{one.unit.dimension for one in own} for own in inner if own]
    if dimensions and not reduce(set.intersection, dimensions):
        listed = " and ".join(
            f"`{arg}` in {_written(own)}" for arg, own in zip(term.args, inner, strict=True) if own
        )
        raise TraceError(
            f"`{term}` of topic {topic.name} ({topic.type}): {listed} cannot be added or compared"
        )


def expect_units(name: str, bound: Bound, schema: Schema, topic: Topic) -> None:
    """See that values that feed a name are in its unit, as far as the messages say it.

    Raises:
        TraceError: they are not, or units in a value contradict each other.
    """
    if bound.value is not None:
        _expect(name, bound.value, schema.units.get(name, ""), bound.unit, topic)
    for field, term in bound.fields.items():
        full = f"{name}.{field}"
        _expect(full, term, schema.units.get(full, ""), "", topic)


def _expect(name: str, term: Term, declared: str, given: str, topic: Topic) -> None:
    found = measures_of(term, topic)
    if not found or not declared:
        return
    target = parse_unit(given or declared)
    alike = [one for one in found if one.unit.dimension == target.dimension]
    where = f"topic {topic.name} ({topic.type})" if topic.type else f"topic {topic.name}"
    is_so = f"`{term}` of {where} is {_written(found)}"
    wanted = f"`{name}` is declared [{declared}]"
    if not alike:
        raise TraceError(
            f"{wanted}, and {is_so}: bind what is in [{declared}]{_such(target, topic)}"
        )
    if any(not one.is_exact or one.unit.factor == target.factor for one in alike):
        return
    says = f"and `unit` says [{given}]" if given else "in which it would be judged as it is"
    fix = f'write `unit = "{alike[0].unit.symbol or 1}"` in a binding, and it is converted'
    raise TraceError(f"{is_so}; {wanted}, {says}: {fix}")


def _such(target: Unit, topic: Topic) -> str:
    fields = [
        f"`{leaf}`"
        for leaf in topic.leaves
        if any(unit.dimension == target.dimension for unit in meaning_of(leaf, topic).units)
    ]
    return f", such as {' or '.join(fields[:3])}" if fields and target.dimension else ""


def _written(found: Iterable[Measure]) -> str:
    """Units as a person reads them.

    >>> _written([Measure(parse_unit("rad")), Measure(PLAIN)])
    'in [rad] or a plain number'
    """
    listed = [
        f"in [{one.unit.symbol}]" if one.unit.dimension else "a plain number" for one in found
    ]
    return " or ".join(dict.fromkeys(listed))
