"""CTL properties, and the response monitors derived from them."""

from tests.tools.each import each

from rvmon.language.checked.formula import Interval
from rvmon.language.checked.properties import (
    ModelAtom,
    PathBinary,
    StateAtom,
)
from rvmon.language.print import format_formula

ROLES = """signal ok, near : bool input
signal v : real [m/s] output
signal both : bool
event sensed input
event released, stopped output
"""


def test_bounds_and_until(checked):
    formula = checked("property P: A[a U[0, 3 s] E[b W c]]").properties["P"].formula
    assert isinstance(formula, PathBinary)
    assert formula.interval == Interval(0, 3 * 10**9)
    assert isinstance(formula.right, PathBinary)
    assert checked("property P: AF<=3 s a").properties["P"].formula.interval.high == 3 * 10**9


def test_names_of_a_model(checked, codes):
    found = checked("property P: E<> a and Robot.done and t < 5").properties["P"]
    left, right = found.formula.operand.left, found.formula.operand.right
    assert (left.left, right) == (
        StateAtom(left.left.formula, left.left.span),
        ModelAtom("t < 5", right.span),
    )
    assert codes("signal released : bool\nproperty P: E<> relased") == ["RV052"]


RESPONSE = f"{ROLES}requirement R\n  monitor as response within 3 s\n  property "


@each(
    ("text", "code"),
    [
        ("property P: A[] (a -> eventually b)", "RV051"),
        ("property P: A[] a until b", "RV051"),
        ("property P: A[a and b]", "RV051"),
        ("property P: AX[0, 1 s] a", "RV051"),
        ("property P: A[] (eventually Robot.done)", "RV051"),
        ("property P: A[] (AG a) < 3", "RV050"),
        ("property P: A[] (d < 3)", "RV023"),
        ("property P: AG a and b", "RV002"),
        # A requirement is about one run.
        ("requirement R upon a then EF b", "RV050"),
        ("define p = A[] a\nrequirement R p", "RV050"),
        # A response monitor needs a property that separates inputs from outputs.
        ("requirement R monitor as response within 3 s", "RV053"),
        (RESPONSE + "E<> (sensed or released)", "RV053"),
        (RESPONSE + "E<> (sensed and ok)", "RV053"),
        (RESPONSE + "E<> (both and released)", "RV053"),
        (RESPONSE + "A[] released", "RV053"),
        (RESPONSE + "E<> (EF released)", "RV053"),
        (RESPONSE + "E<> (Robot.done and released)", "RV053"),
        (RESPONSE + "E<> (true and released)", "RV053"),
    ],
)
def test_refused_properties(codes, text, code):
    assert codes(text) == [code]


def response(checked, body):
    """The trigger and consequent of a derived monitor."""
    found = checked(RESPONSE + body).requirements["R"]
    return format_formula(found.trigger), format_formula(found.consequent)


@each(
    ("body", "trigger", "consequent"),
    [
        ("E<> (sensed and ok and released)", "sensed and ok", "within 3 s released"),
        (
            "EF (released and sensed and stopped and not near)",
            "sensed and not near",
            "within 3 s (released and stopped)",
        ),
        ("E<> (released and v < 1 m/s)", "start", "within 3 s (released and v < 1 m/s)"),
        ("E<> (sensed and not released)", "sensed", "for 3 s not released"),
        (
            "E<> (sensed and released and not stopped)",
            "sensed",
            "(within 3 s released) and for 3 s not stopped",
        ),
        ("E<> ((sensed or ok) and released)", "sensed or ok", "within 3 s released"),
    ],
)
def test_response_monitor(checked, body, trigger, consequent):
    """Inputs are the trigger; outputs must hold together, negated outputs never."""
    assert response(checked, body) == (trigger, consequent)
