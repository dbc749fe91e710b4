"""Types, units and constants are converted exactly, or refused."""

from fractions import Fraction

import pytest
from tests.tools.each import each

from rvmon.language.checked.formula import Literal, SignalAtom
from rvmon.language.print import format_formula
from rvmon.units import UnknownUnitError, parse_unit


@each(
    ("text", "code"),
    [
        ("always x", "RV020"),
        ("always state", "RV020"),
        ("always not d", "RV020"),
        ("always a < 3", "RV020"),
        ("always a + 1 < 3", "RV020"),
        ("always e < 3", "RV020"),
        ("always a == true", "RV020"),
        ("always age(d)", "RV020"),
        ("always age(d) + 1 s > 2 s", "RV020"),
        ("always age(d) == 2 s", "RV020"),
        ("always age(d) > x", "RV030"),
        ("always hypot(x) < 3", "RV021"),
        ("always known(a and b)", "RV021"),
        ("always known(e)", "RV021"),
        ("always prev(x + 1) < 2", "RV021"),
        ("always rate(state) == idle", "RV021"),
        ("always d < speed", "RV022"),
        ("always d < 3 s", "RV022"),
        ("always x < 3 m", "RV022"),
        ("always d + x < 3 m", "RV022"),
        ("always sqrt(d) < 3", "RV022"),
        ("always d < 3", "RV023"),
        ("always d + 3 < 4 m", "RV023"),
        ("always d < 3 metres", "RV024"),
        ("always x < 1e99999999999", "RV025"),
        ("always x < 1 / 0", "RV025"),
        ("always x < y / 0", "RV025"),
        ("always x < sqrt(0 - 1)", "RV025"),
        ("always x < 1e300 * 1e300", "RV025"),
        ("always state < moving", "RV026"),
        ("always state == 3", "RV026"),
        ("always state + 1 == 3", "RV026"),
        ("always x == state", "RV026"),
        ("always state == mooving", "RV013"),
        ("always moving", "RV012"),
        ("always pick.z < 3", "RV012"),
        ("always foo(a)", "RV014"),
        ("always held(a, x)", "RV030"),
        # Products carry units.
        ("always d * d < 4 m^2", ""),
        ("always sqrt(d * d) < 4 m", ""),
        ("always hypot(d, d) < 4 m", ""),
        ("always d / speed < 4 s", ""),
        ("always rate(d) < speed", ""),
        ("always delta(d) < 3 cm", ""),
        ("always d * speed < 4 m", "RV022"),
        # Only real signals ignore NaN.
        *((f"always a\nsignal z : {t} ignore NaN", "RV027") for t in ("bool", "int", "{one, two}")),
        ("always a\nsignal z : real ignore NaN stale after 1 s", ""),
        ("always a\nsignal z : real [m] input ignore NaN", ""),
    ],
)
def test_mismatches_are_refused(codes, text, code):
    assert codes(f"requirement R {text}") == code.split()


@each(
    ("text", "value"),
    [
        ("d < 5 cm", 0.05),
        ("d < 3 inch", 0.0762),
        ("d < 100 mm + 1 cm", 0.11),
        ("d < 0", 0.0),
        ("d < 2 * 3 m", 6.0),
        ("speed < 1 m / 4 s", 0.25),
        ("n < 3", 3),
        ("n < 2.5", 2.5),
        ("x < 1/3", 1 / 3),
        ("x < min(3, 2) + abs(0 - 1)", 3.0),
    ],
)
def test_constants_are_converted_once_to_the_nearest_float(requirement, text, value):
    """Constants are computed with fractions and rounded at the end, in the signal's unit."""
    right = requirement(f"always {text}").consequent.right
    assert isinstance(right, Literal)
    assert right.value == value
    assert type(right.value) is type(value)


@each(
    ("formula", "printed"),
    [
        ("5 cm < d", "0.05 m < d"),
        ("d < z", "d < z * 0.01"),
        ("w < 180 deg", "w < 3.141592653589793 rad"),  # degrees and radians measure the same
        ("eventually 3 s < 200 ms", "eventually false"),
        ("pick.ok or prev(a)", "pick.ok or prev(a)"),
    ],
)
def test_comparison_is_made_in_the_unit_of_the_signal(checked, formula, printed):
    spec = checked(
        f"signal z : real [cm]\nsignal w : real [rad]\nrequirement R upon start then {formula}"
    )
    assert format_formula(spec.requirements["R"].consequent) == printed


def test_label_equals_its_own_signal_first(checked):
    """A name compared with a labelled signal is a label, even if a signal has that name."""
    spec = checked("signal moving : bool\nrequirement R always (state == moving -> moving)")
    requirement = spec.requirements["R"]
    assert requirement.trigger.right == Literal("moving")
    assert isinstance(requirement.consequent, SignalAtom)


@each("text", ["m/", "/s", "m//s", "m s", "furlong", "", "m^x", "m" * 100])
def test_malformed_units_are_refused(text):
    if text:
        with pytest.raises(UnknownUnitError):
            parse_unit(text)
    else:
        assert parse_unit(text).dimension == ()


@each(
    ("text", "base", "factor"),
    [
        ("km/h", "m/s", Fraction(5, 18)),
        ("N", "kg*m/s^2", 1),
        ("mbar", "Pa", 100),
        ("kW", "J/s", 1000),
        ("Hz", "1/s", 1),
        ("min", "s", 60),
        ("rev", "deg", 360),
        ("Mbit/s", "kB/s", 125),
    ],
)
def test_unit_factors(text, base, factor):
    assert parse_unit(text).dimension == parse_unit(base).dimension
    assert parse_unit(text).factor / parse_unit(base).factor == factor


@pytest.mark.parametrize("text", ["stale after 1 s ignore NaN", "ignore nan", "ignore"])
def test_ignore_nan_is_written_after_the_type(text, message):
    assert "write `ignore NaN` after the type" in message(f"signal z : real {text}\n")
