"""Whole numbers in the core: exact within 64 bits; real ones are doubles."""

import numpy as np
import pytest

import rvmon

MOST = 2**63 - 1


def spec_of(required: str) -> rvmon.Spec:
    """A specification of one requirement about numbers."""
    return rvmon.loads(
        "spec s\nsignal x, y : int\nsignal z : real\nevent e(k: int)\n"
        f"requirement R1\n  always ({required})\n"
    )


def forms_of(x: int, y: int, z: float = 0.0):
    """The same two samples as arrays, and as samples."""
    yield {"t": np.arange(2), "x": np.array([0, x]), "y": np.array([0, y]), "z": np.array([0, z])}
    yield [(0.0, {"x": 0, "y": 0, "z": 0.0}), (1.0, {"x": x, "y": y, "z": z})]


@pytest.mark.parametrize(
    ("required", "x", "y", "verdict"),
    [
        ("x == y", 2**53 + 1, 2**53, "F"),
        ("x == y", 2**53, -(2**53) - 1, "F"),
        ("x == y", MOST, MOST, "P"),
        ("x - y == 0 or x - y == 1", 2**62, 2**62 - 1, "P"),
        ("x + y < 9223372036854775807", 2**62, 2**62 - 1, "F"),
        ("3 * x != y", 2**53 + 1, 3 * 2**53 + 3, "F"),
        ("x * y <= 4503599627370495", 2**26 - 1, 2**26, "P"),
        ("max(x, y) + 1 != 9007199254740994", 2**53, 2**53 + 1, "F"),
        ("delta(x) < 9007199254740993", 2**53 + 1, 0, "F"),
        ("prev(x) + x < 9007199254740993", 2**53 + 1, 0, "F"),
        ("x < 10 or x > 9007199254740993", 2**53 + 2, 0, "P"),
        ("x < 10 or x > 9007199254740993", 2**53 + 1, 0, "F"),
        ("x < 9007199254740993", 2**53, 0, "P"),
        ("abs(x) >= 0", -MOST, 0, "P"),
        ("hypot(x, y) < 1e17", 2**53, 2**53, "P"),
        ("x / y < 0.3 or y == 0 or x > 2", 2**53, 3, "P"),
    ],
)
def test_whole_numbers_are_exact(required, x, y, verdict):
    """Within 64 bits the core says what Python's own numbers say."""
    spec = spec_of(required)
    for trace in forms_of(x, y):
        report = spec.evaluate(trace, allow_missing=["e"])
        assert report.verdicts == {"R1": verdict}


@pytest.mark.parametrize(
    ("required", "x", "y"),
    [
        ("x + y > 0", MOST, 1),
        ("x - y > 0", MOST, -1),
        ("x * y > 0", 2**32, 2**32),
        ("abs(x) >= 0", -(2**63), 0),
        ("0 - x > 0", -(2**63), 0),
        ("delta(x) - 1 < 0", -(2**63), 0),
    ],
)
def test_what_leaves_64_bits_is_unknown(required, x, y):
    """No sum of two numbers that are there is one that is not."""
    spec = spec_of(f"{required} or x == 0")
    for trace in forms_of(x, y):
        report = spec.evaluate(trace, allow_missing=["e"])
        assert report.verdicts == {"R1": "I"}


@pytest.mark.parametrize(
    ("required", "x", "z", "verdict"),
    [
        ("x == z", 2**53 + 1, float(2**53), "F"),
        ("x > z or x == 0", 2**53 + 1, float(2**53), "P"),
        ("x < z or x == 0", MOST, 2.0**63, "P"),
        ("x == z", 2**60, 2.0**60, "P"),
    ],
)
def test_a_whole_number_beside_a_real_one_is_compared_exactly(required, x, z, verdict):
    """It is not rounded to a double first."""
    spec = spec_of(required)
    for trace in forms_of(x, 0, z):
        report = spec.evaluate(trace, allow_missing=["e"])
        assert report.verdicts == {"R1": verdict}


def test_a_whole_number_for_a_real_one_is_rounded_once():
    """The nearest double, ties to even, be it within 64 bits or beyond."""
    spec = rvmon.loads(
        "spec s\nsignal z : real\nrequirement R1\n  upon start\n  then z == 0\n  let v = z\n"
    )
    for whole in (2**53 + 1, 2**53 + 3, 2**63 + 1025, 2**70 + 1, -(2**53) - 1):
        (failed,) = spec.monitor().step(0.0, {"z": whole})
        assert failed.captured == {"v": float(whole)}
        assert isinstance(failed.captured["v"], float)


def test_fields_are_exact():
    """The whole numbers of a payload are those that came, too."""
    spec = spec_of("not (e.k == 9007199254740993)")
    for k, verdict in ((2**53, "P"), (2**53 + 1, "F")):
        trace = [(0.0, {}), (1.0, {"e": {"k": k}})]
        assert spec.evaluate(trace).verdicts == {"R1": verdict}
    for k in (2**63, 10**400):
        with pytest.raises(rvmon.TraceError, match=r"sample at 1 s: `e.k` is a number too large"):
            spec.evaluate([(0.0, {}), (1.0, {"e": {"k": k}})])


def test_doubles_are_doubles():
    """Large ones are computed with as Python does."""
    spec = spec_of("z * z + 1000000 * z < 1e300")
    trace = {"t": np.arange(2), "z": np.array([1e19, 2e150])}
    report = spec.evaluate(trace, allow_missing=True)
    assert report.verdicts == {"R1": "F"}


def test_a_number_of_many_digits_in_a_file_is_refused(tmp_path):
    """A whole number that is none of 64 bits is an error of the recording."""
    path = tmp_path / "a.csv"
    path.write_text(f"t,x\n0,1\n1,{'9' * 400}\n")
    with pytest.raises(
        rvmon.TraceError, match=r"line 3: column `x`: .* is too large for a whole number"
    ):
        spec_of("x > 0").evaluate(path, allow_missing=True)
