"""Macros and constants are hygienic, may be overridden, and are checked in place."""

import pytest
from tests.tools.each import each

from rvmon.errors import SpecError
from rvmon.language.compile import compile_text
from rvmon.language.print import format_formula


def printed(spec):
    return format_formula(spec.requirements["R"].consequent)


@pytest.mark.parametrize(
    ("defined", "required", "expected"),
    [
        (
            "define soon(p, lim) = within lim p\ndefine near(z, l) = z < l\n"
            "define is(l) = state == l",
            "upon start then soon(near(d, 5 cm) and is(idle), 2 * 500 ms)",
            "within 1 s (d < 0.05 m and state == idle)",
        ),
        # A parameter does not capture a signal of the same name in the argument.
        (
            "define both(a, b) = a and next_to(b, a)\ndefine next_to(a, b) = not a or b",
            "upon start then eventually both(b, a)",
            "eventually (b and (not a or b))",
        ),
        # An argument may read a `let` of the requirement.
        ("define soon(p) = within 1 s p", "upon e then soon(d > v) let v = d", "within 1 s d > v"),
        # A call may be an argument of the same macro.
        ("define m(p) = not p", "upon start then eventually m(m(a))", "eventually not not a"),
    ],
)
def test_macros_with_parameters(checked, defined, required, expected):
    """Arguments may be formulas, numbers, durations or labels, and their names stay theirs."""
    assert printed(checked(f"{defined}\nrequirement R {required}")) == expected


MACRO = "define p(y, z) = y or z\nrequirement R always "


@each(
    ("text", "code"),
    [
        # A macro cannot read names of the requirement that calls it.
        ("define far = d > v\nrequirement R upon e then within 1 s far let v = d", "RV012"),
        # A fault is reported once.
        ("define p = aa or b\nrequirement R1 always p\nrequirement R2 always not p", "RV012"),
        ("define p(z) = z or bb\nrequirement R always p(a)", "RV012"),
        (f"{MACRO} p(a, b, c)", "RV021"),
        (f"{MACRO} p", "RV021"),
        ("const T = x", "RV020"),
        ("const T = a", "RV020"),
        # Names that are taken.
        ("define a = b", "RV011"),
        ("const a = 3", "RV011"),
        ("define abs(z) = z", "RV011"),
        ("event z(k: int, k: int)", "RV011"),
        ("signal z : {k, k}", "RV011"),
        ("requirement R always a\nrequirement R always b", "RV011"),
        ("spec other", "RV011"),
        ("define m(p, p) = p", "RV011"),
        ("signal pick.x : bool", "RV011"),
        ("requirement R upon e then F b let a = d", "RV011"),
        ("requirement R upon e then F a let v = d let v = d", "RV011"),
        ("requirement R upon pick then F a for each v in pick.id let v = d", "RV011"),
    ],
)
def test_refused_macros(codes, text, code):
    assert codes(text) == [code]


@pytest.mark.parametrize(
    "text",
    ["define p = p", "define p = q\ndefine q = a or p", "const T = T + 1 s",
     "define p(z) = q(z)\ndefine q(z) = p(z)", "define p = q\ndefine q = r\ndefine r = q"],
)  # fmt: skip
def test_recursion_is_an_error(codes, text):
    assert codes(text) == ["RV015"]
    assert codes(f"{text}\nrequirement R always (a and b)") == ["RV015"]


def test_override():
    text = "const T = 3 s\nevent a, b\nrequirement R upon a then within T b"
    spec, _ = compile_text(text, constants={"T": "2s"})
    assert printed(spec) == "within 2 s b"
    with pytest.raises(SpecError, match=r"no constant named `S`.*\n.*there are T"):
        compile_text(text, constants={"S": "2 s"})
    with pytest.raises(SpecError, match=r"<constant T>:1:"):
        compile_text(text, constants={"T": "2 +"})
    with pytest.raises(SpecError, match="is not a duration"):
        compile_text(text, constants={"T": "2"})


@pytest.mark.slow
def test_expansion_is_limited(codes):
    doubling = "define m0 = a\n" + "".join(f"define m{i + 1} = m{i} and m{i}\n" for i in range(60))
    assert set(codes(f"{doubling}requirement R always m60")) == {"RV005"}
    doubling = "define m0(p) = p\n" + "".join(
        f"define m{i + 1}(p) = m{i}(p) and m{i}(p)\n" for i in range(60)
    )
    assert set(codes(f"{doubling}requirement R always m60(a)")) == {"RV005"}
