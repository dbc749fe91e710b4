"""Every arithmetic operation has a complete entry in the table."""

import re

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.checked.arithmetic import NumericOp, UnitRule

ANGLES = (UnitRule.OF_ANGLE, UnitRule.TURN, UnitRule.PLACES)


def head(op):
    """Declarations of signals of the kind that an operation takes."""
    kind = "int" if op.entry.unit is UnitRule.BITS else "real"
    unit = " [rad]" if op.entry.unit in ANGLES else ""
    return f"spec s\nsignal x, y : {kind}{unit}\nsignal z : real{unit}\n"


def wanted_unit(op):
    """The unit of the result, as written after a number."""
    return {
        UnitRule.TO_ANGLE: " rad",
        UnitRule.DIRECTION: " rad",
        UnitRule.TURN: " rad",
        UnitRule.PLACES: " m",
    }.get(op.entry.unit, "")


@each("op", [op for op in NumericOp if op.is_function])
def test_a_wrong_number_of_arguments_is_refused(op):
    for count in range(1, 6):
        called = f"{op}({', '.join('x' * count)})"
        body = called if op is NumericOp.BIT else f"{called} < 1{wanted_unit(op)}"
        text = f"{head(op)}requirement R1\n  always {body}\n"
        since_start = op in (NumericOp.MIN, NumericOp.MAX) and count == 1
        if op.entry.least <= count <= (op.entry.most or count) or since_start:
            assert rvmon.loads(text)
        else:
            with pytest.raises(rvmon.SpecError, match=re.escape(f"`{op}` takes")):
                rvmon.loads(text)


@each("op", [op for op in NumericOp if op is not NumericOp.BIT])
def test_constants_are_computed_like_values(op):
    """The checker and a monitor compute the same number."""
    whole = op.entry.unit is UnitRule.BITS
    numbers = [4, 3] if whole else [0.75, 0.5, 0.5, 0.25]
    numbers, names = numbers[: op.entry.least], ["x", "y", "y", "z"]
    form = "-{}" if op is NumericOp.NEG else f"{{}} {op} {{}}"
    if op.is_function:
        form = f"{op}({', '.join(['{}'] * op.entry.least)})"
    unit = " rad" if op.entry.unit in ANGLES else ""
    constant = form.format(*(f"{one}{unit}" for one in numbers))
    wanted = f"{op.entry.apply(*numbers)!r}{wanted_unit(op)}"
    small = f"0.000001{wanted_unit(op)}"
    bodies = [
        f"always abs({one} - ({wanted})) < {small}" for one in (constant, form.format(*names))
    ]
    text = "".join(f"requirement R{n}\n  {body}\n" for n, body in enumerate(bodies))
    values = {"x": numbers[0], "y": numbers[1] if len(numbers) > 1 else 0, "z": 0.25}
    verdicts = rvmon.loads(head(op) + text).evaluate([(0, values)]).verdicts
    assert [one.value for one in verdicts.values()] == ["P", "P"]


@each(
    ("call", "message"),
    [
        ("sin(x) < 1", "`sin` takes an angle, `x` has no unit"),
        ("exp(d) < 1", "`exp` takes a plain number, `d` comes in [m]"),
        ("pow(d, x) < 1 m", "leaves the power of [m] open"),
        ("angle_between(d, d) < 1 m", "`angle_between` takes an angle, `d` comes in [m]"),
        ("bit(x, 3)", "`bit` needs a number of type `int`, and `x` is not one"),
        ("bit_and(n, 2.5) > 1", "`bit_and` needs a number of type `int`, and `2.5` is not one"),
        ("bit(n, 3) == 1", "true or false and is not compared"),
        ("asin(2) < 1 rad", "`asin(2)` is out of range"),
    ],
)
def test_arguments_that_no_function_takes_are_refused(call, message):
    head = "spec s\nsignal x : real\nsignal n : int\nsignal d : real [m]\n"
    text = f"{head}requirement R\n  always {call}\n"
    with pytest.raises(rvmon.SpecError, match=re.escape(message)):
        rvmon.loads(text)


@each(
    ("claim", "values"),
    [
        ("angle_between(a, 350 deg) == -20 deg", {"a": 10.0}),
        ("angle_between(350 deg, a) == 20 deg", {"a": 10.0}),
        ("angle_between(a, a + 180 deg) == 180 deg", {"a": 10.0}),
        ("abs(sin(a) - 0.5) < 1e-12", {"a": 30.0}),
        ("pow(d, 2) == 9 m^2 and pow(d, -1) <= 0.334 / 1 m", {"d": 3.0}),
        ("bit(n, 7) and not bit(n, 6) and bit(n, 63)", {"n": -128}),
        ("shift_left(n, 3) == 40 and shift_right(n, 1) == 2", {"n": 5}),
        ("mod(d, 2 m) == 1 m and mod(-d, 2 m) == 1 m", {"d": 3.0}),
        ("round(d) == 3 m and floor(d) == 2 m and ceil(d) == 3 m", {"d": 2.5}),
        ("clamp(d, 0 m, 2 m) == 2 m and sign(d) == 1", {"d": 2.5}),
        ("atan2(d, d) > 44.9 deg and atan2(d, d) < 45.1 deg", {"d": 2.5}),
        ("abs(distance_on_earth(a, a, 0 deg, 0 deg) - 157.25 km) < 0.01 km", {"a": 1.0}),
    ],
)
def test_functions_know_their_units(claim, values):
    head = "spec s\nsignal a : real [deg]\nsignal d : real [m]\nsignal n : int\n"
    spec = rvmon.loads(f"{head}requirement R\n  always ({claim})\n")
    report = spec.evaluate([(0, values)], allow_missing=True)
    assert report.verdicts["R"].value == "P"
