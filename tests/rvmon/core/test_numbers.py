"""Numbers in the core: whole numbers are exact within 64 bits, real ones are doubles."""

import numpy as np
import pytest
from tests.tools.each import each

import rvmon

MOST = 2**63 - 1


def spec_of(required: str) -> rvmon.Spec:
    return rvmon.loads(
        "spec s\nsignal x, y : int\nsignal z : real\nevent e(k: int)\n"
        f"requirement R1\n  always ({required})\n"
    )


EXACT = [
    ("x == y", {"x": 2**53 + 1, "y": 2**53}, "F"),
    ("x == y", {"x": MOST, "y": MOST}, "P"),
    ("x - y == 0 or x - y == 1", {"x": 2**62, "y": 2**62 - 1}, "P"),
    ("x + y < 9223372036854775807", {"x": 2**62, "y": 2**62 - 1}, "F"),
    ("3 * x != y", {"x": 2**53 + 1, "y": 3 * 2**53 + 3}, "F"),
    ("max(x, y) + 1 != 9007199254740994", {"x": 2**53, "y": 2**53 + 1}, "F"),
    ("delta(x) < 9007199254740993", {"x": 2**53 + 1}, "F"),
    ("x < 10 or x > 9007199254740993", {"x": 2**53 + 2}, "P"),
    ("x < 10 or x > 9007199254740993", {"x": 2**53 + 1}, "F"),
    ("x / y < 0.3 or y == 0 or x > 2", {"x": 2**53, "y": 3}, "P"),
    # A whole number is compared with a real one exactly, not rounded to a double first.
    ("x == z", {"x": 2**53 + 1, "z": float(2**53)}, "F"),
    ("x < z or x == 0", {"x": MOST, "z": 2.0**63}, "P"),
    # A result beyond 64 bits is unknown.
    ("x + y > 0 or x == 0", {"x": MOST, "y": 1}, "I"),
    ("x * y > 0 or x == 0", {"x": 2**32, "y": 2**32}, "I"),
    ("abs(x) >= 0 or x == 0", {"x": -(2**63)}, "I"),
    ("0 - x > 0 or x == 0", {"x": -(2**63)}, "I"),
    ("delta(x) - 1 < 0 or x == 0", {"x": -(2**63)}, "I"),
    ("not (e.k == 9007199254740993)", {"e": {"k": 2**53}}, "P"),
    ("not (e.k == 9007199254740993)", {"e": {"k": 2**53 + 1}}, "F"),
    # Doubles may be large.
    ("z * z + 1000000 * z < 1e300", {"z": 2e150}, "F"),
]


@each(("required", "values", "verdict"), EXACT)
def test_whole_numbers_are_exact_or_unknown(required, values, verdict):
    """Within 64 bits the core computes as Python does, on columns and on samples."""
    spec, before = spec_of(required), {"x": 0, "y": 0, "z": 0.0}
    after = before | values
    columns = {name: [before.get(name), one] for name, one in after.items()}
    arrays = {name: np.array(column) for name, column in columns.items() if name != "e"}
    event = {name: columns[name] for name in ("e",) if name in columns}
    for trace in ({"t": np.arange(2), **arrays, **event}, [(0.0, before), (1.0, after)]):
        assert spec.evaluate(trace, allow_missing=["e"]).verdicts == {"R1": verdict}


def test_a_whole_number_given_for_a_real_signal_is_rounded_once():
    """To the nearest double, ties to even, within 64 bits and beyond."""
    spec = rvmon.loads(
        "spec s\nsignal z : real\nrequirement R1\n  upon start\n  then z == 0\n  let v = z\n"
    )
    for whole in (2**53 + 1, 2**53 + 3, 2**63 + 1025, 2**70 + 1, -(2**53) - 1):
        (failed,) = spec.monitor().step(0.0, {"z": whole})
        assert failed.captured == {"v": float(whole)}
        assert isinstance(failed.captured["v"], float)


def test_a_whole_number_of_too_many_digits_in_a_file_is_refused(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(f"t,x\n0,1\n1,{'9' * 400}\n")
    with pytest.raises(
        rvmon.TraceError, match=r"line 3: column `x`: .* is too large for a whole number"
    ):
        spec_of("x > 0").evaluate(path, allow_missing=True)
