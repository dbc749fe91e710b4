"""Whole numbers in compiled C: judged as Python computes them, or refused."""

import numpy as np
import pytest

import rvmon
from rvmon.codegen.c_source import c_files

pytestmark = pytest.mark.compiler

MOST = 2**53


def spec_of(owed: str) -> rvmon.Spec:
    """A specification of one requirement about whole numbers."""
    return rvmon.loads(
        "spec s\nsignal x, y : int\nsignal z : real\nevent e(k: int)\n"
        f"requirement R1\n  always ({owed})\n"
    )


def forms_of(x: int, y: int):
    """The same two samples as arrays, and as samples."""
    yield {"t": np.arange(2), "x": np.array([0, x]), "y": np.array([0, y]), "z": np.zeros(2)}
    yield [(0.0, {"x": 0, "y": 0, "z": 0.0}), (1.0, {"x": x, "y": y, "z": 0.0})]


@pytest.mark.parametrize(
    ("owed", "x", "y"),
    [
        ("x == y", MOST + 1, MOST),
        ("x == y", MOST, -MOST - 1),
        ("x == y", -(2**63), 0),
        ("x + y < 1000", 2**52 + 1, 2**52),
        ("x - y < 1000", 2**52 + 1, -(2**52)),
        ("3 * x != y", 2**52 + 1, 0),
        ("x * y < 1000", 2**26 + 1, 2**27 + 1),
        ("abs(x) + z < y / 2", MOST + 1, 0),
        ("max(x, y) + 1 != y", MOST, 1),
        ("delta(x) < 1000", MOST - 1, 0),
        ("rate(x) < 1000", 2**32 + 1, 0),
        ("prev(x) + x < 1000", 2**52 - 1, 0),
    ],
)
def test_numbers_beyond_doubles_are_refused(owed, x, y):
    """Where a double might not be exact, the sample, the name and what to do are told."""
    spec = spec_of(owed)
    for trace in forms_of(x, y):
        spec.evaluate(trace)
        with pytest.raises(
            rvmon.TraceError, match=r"sample at 1 s: `[xy]` is -?\d.* engine `auto`"
        ):
            spec.evaluate(trace, engine="c")


@pytest.mark.parametrize(
    ("owed", "x", "y", "verdict"),
    [
        ("x == y", MOST, MOST, "P"),
        ("x == y", MOST - 1, MOST, "F"),
        ("x < 10 or x > 9007199254740991", MOST, 0, "P"),
        ("x + y < 4503599627370497", 2**51, 2**51, "P"),
        ("x * y <= 4503599627370495", 2**26 - 1, 2**26, "P"),
        ("x / y < 0.3 or y == 0 or x > 2", MOST, 3, "P"),
        ("x * 0.5 < 4503599627370496", MOST, 0, "F"),
        ("hypot(x, y) < 1e17", MOST, MOST, "P"),
        ("e.k < 5 or x == 0 or x == 9007199254740992", MOST, 0, "P"),
    ],
)
def test_numbers_within_doubles_are_judged(owed, x, y, verdict):
    """Up to what doubles hold, compiled C says what the other engines say."""
    spec = spec_of(owed)
    for trace in forms_of(x, y):
        for engine in ("automaton", "c"):
            report = spec.evaluate(trace, engine=engine, allow_missing=["e"])
            assert report.verdicts == {"R1": verdict}, engine


def test_fields_have_their_limits():
    """The whole numbers of a payload are looked at as well."""
    spec = spec_of("not (e.k * e.k > 5)")
    trace = [(0.0, {}), (1.0, {"e": {"k": 2**26}})]
    for engine in ("automaton", "c"):
        assert spec.evaluate(trace, engine=engine).verdicts == {"R1": "F"}
    for k in (2**26 + 2**10, 10**400):
        with pytest.raises(rvmon.TraceError, match=r"sample at 1 s: `e.k` is"):
            spec.evaluate([(0.0, {}), (1.0, {"e": {"k": k}})], engine="c")


def test_floats_have_no_limit():
    """Of floats Python makes doubles, too."""
    spec = spec_of("z * z + 1000000 * z < 1e300")
    trace = {"t": np.arange(2), "z": np.array([1e19, 2e150])}
    for engine in ("automaton", "c"):
        assert spec.evaluate(trace, engine=engine).verdicts == {"R1": "F"}


def test_a_number_of_many_digits_in_a_file_is_refused(tmp_path):
    """A whole number that no double holds at all is an error of the recording."""
    path = tmp_path / "a.csv"
    path.write_text(f"t,x\n0,1\n1,{'9' * 400}\n")
    with pytest.raises(rvmon.TraceError, match=r"sample at 1 s: `x` is 9"):
        spec_of("x > 0").evaluate(path, engine="c")


def test_a_bound_that_is_no_double_is_refused():
    """The number is named: another bound would be judged than the specification has."""
    trace = next(forms_of(1, 1))
    assert spec_of("x < 9007199254740994").evaluate(trace, engine="c").verdicts == {"R1": "P"}
    with pytest.raises(rvmon.RvmonError, match="9007199254740993 has more digits"):
        spec_of("x < 9007199254740993").evaluate(trace, engine="c")
    with pytest.raises(rvmon.RvmonError, match="9007199254740993 has more digits"):
        c_files(spec_of("x < 9007199254740993").plan())
