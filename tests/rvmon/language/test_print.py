"""A printed formula is read back as the same formula."""

import random

import pytest

from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import (
    Arithmetic,
    Binary,
    BinaryOp,
    Compare,
    Literal,
    SignalValue,
)
from rvmon.language.compile import compile_text
from rvmon.language.print import format_formula, format_numeric
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import show_spec
from rvmon.units import unit_table

_CHAINED = (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR, BinaryOp.IFF)


def meaning(spec):
    """The content of a specification, equal for two that differ only in places and brackets."""
    return (
        (spec.time, spec.period),
        tuple((s.name, s.type, s.ignores_nan, s.stale_after) for s in spec.signals.values()),
        tuple((e.name, tuple(e.fields.items())) for e in spec.events.values()),
        tuple(_bare(requirement) for requirement in spec.requirements.values()),
    )


def _bare(node):
    """A node without its place; a chain of an associative connective as a flat tuple."""
    match node:
        case Binary(op=op) if op in _CHAINED:
            return (op, *_operands(node, op))
        case tuple():
            return tuple(map(_bare, node))
        case _ if hasattr(type(node), "__match_args__"):
            kept = (name for name in type(node).__match_args__ if name not in ("span", "unit"))
            return (type(node).__name__, *(_bare(getattr(node, name)) for name in kept))
        case _:
            return node


def _operands(node, op):
    if isinstance(node, Binary) and node.op is op:
        return (*_operands(node.left, op), *_operands(node.right, op))
    return (_bare(node),)


@pytest.mark.law
def test_parse_after_print_is_identity():
    for seed in range(80):
        spec = random_spec(random.Random(seed), Profile())
        once, _ = compile_text(show_spec(spec))
        if not any(map(is_constant_arithmetic, numbers_of(spec))):  # the compiler folds them
            assert meaning(once) == meaning(spec)
        twice, _ = compile_text(show_spec(once))
        assert meaning(twice) == meaning(once)


def numbers_of(spec):
    """All numbers of a specification, including nested ones."""
    for requirement in spec.requirements.values():
        for formula in (requirement.trigger, requirement.consequent):
            for part in subformulas(formula):
                if isinstance(part, Compare):
                    yield part
                    yield from arithmetic_in((part.left, part.right))


def arithmetic_in(numbers):
    """The numbers that are arithmetic, including nested ones."""
    for number in numbers:
        if isinstance(number, Arithmetic):
            yield number
            yield from arithmetic_in(number.args)


def is_constant_arithmetic(node):
    """Whether all operands of an operation or comparison are literals."""
    args = (node.left, node.right) if isinstance(node, Compare) else node.args
    return all(isinstance(arg, Literal) for arg in args)


def test_literals():
    assert format_numeric(Literal(0.05, "m")) == "0.05 m"
    assert format_numeric(Literal(1e-9)) == "0.000000001"
    assert format_numeric(Literal(1e300)) == "1e+300"
    assert format_numeric(Literal(-3)) == "-3"
    assert format_numeric(SignalValue("next")) == "`next`"
    assert format_numeric(SignalValue("a b.c")) == "`a b.c`"


@pytest.mark.parametrize("value", [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, 2.0**60])
def test_numbers_survive(value):
    spec, _ = compile_text(
        f"signal x : real\nrequirement R always x < {format_numeric(Literal(value))}"
    )
    compare = spec.requirements["R"].consequent
    assert isinstance(compare, Compare)
    assert compare.right.value == value
    assert format_formula(compare).startswith("x < ")


@pytest.mark.slow
def test_units_survive():
    units = [*sorted(unit_table()), "m/s", "1/s", "1/s/m", "m/A", "W*s/m^2"]
    signals = "".join(f"signal x{n} : real [{unit}]\n" for n, unit in enumerate(units))

    def consequents(bodies):
        text = "".join(f"requirement R{n} always ({body})\n" for n, body in enumerate(bodies))
        return [one.consequent for one in compile_text(signals + text)[0].requirements.values()]

    written = consequents(f"x{n} < 0 or 2 * x{n} - x{n} > 0" for n in range(len(units)))
    for one, again in zip(written, consequents(map(format_formula, written)), strict=True):
        assert again.left.right == one.left.right
        assert again.left.right.unit == one.left.right.unit
        assert again.right.left == one.right.left
