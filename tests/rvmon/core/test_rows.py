"""Recordings that the core judges: as the law has it, what is refused, what is missing."""

import math
import random

import numpy as np
import pytest
from tests.rvmon.core.tables import planned_for, random_table, rows_differ
from tests.tools.compare import outcomes
from tests.tools.each import each
from tests.tools.forms import Compiler

import rvmon
from rvmon.testing.generate.spec import Profile, random_spec


def spec_of(declared: str, required: str) -> rvmon.Spec:
    return rvmon.loads(f"spec s\n{declared}\nrequirement R1\n  {required}\n")


DECLARED = """signal x : real
signal n : int
signal b : bool
signal mode : {red, green}
event e
event pay(k: int, m: {low, high})"""


@each(
    ("name", "value"),
    [
        ("x", "9"),
        ("x", True),
        ("x", [1.0]),
        ("x", 1j),
        ("n", 1.5),
        ("n", True),
        ("b", 2),
        ("b", "yes"),
        ("mode", "blue"),
        ("mode", 1),
        ("e", 5),
        ("e", 0.5),
        ("e", "no"),
        ("e", ""),
        ("pay", {"zz": 3}),
        ("pay", {"k": 1.5}),
        ("pay", {"m": "none"}),
    ],
)
def test_values_of_another_type_are_refused(name, value):
    spec = spec_of(DECLARED, "always (x < 5 or n > 2 or b or mode == red or e or pay.k > 2)")
    trace = {"t": [0.0, 1.0], name: [None, value]}
    with pytest.raises(rvmon.TraceError, match=rf"sample at 1 s: .*`{name}"):
        spec.evaluate(trace, allow_missing=True)


@pytest.mark.slow
def test_a_signal_is_not_born_by_nan():
    """What passed before all that it speaks of had a value is inconclusive."""
    declared = "time sampled\nsignal p, q : bool\nsignal x, y : real"
    spec = spec_of(declared, "whenever q then F[3 ns, 6 ns] ((y >= x) U[0 ns, 3 ns] p)")
    trace = {
        "t_ns": np.array([0, 6, 10]),
        "p": np.array([True, True, True]),
        "q": np.array([True, False, False]),
        "x": np.array([math.nan, math.nan, 1.0]),
        "y": np.array([1.0, 0.0, 0.0]),
    }
    (attempt,) = spec.evaluate(trace).attempts
    assert (attempt.verdict, attempt.decided) == ("I", None)


@pytest.mark.law
def test_rows_equal_steps():
    compiler = Compiler()
    judged = 0
    for seed in range(6):
        rng = random.Random(f"rows equal steps {seed}")
        spec = random_spec(rng, Profile(many=8, wide=10))
        planned = planned_for(spec, compiler)
        for _ in range(4):
            table = random_table(rng, spec, planned.single_payloads, 200)
            assert not rows_differ(planned, spec, table), f"seed {seed}"
            judged += len(table.rows)
    assert judged > 1_000


@pytest.mark.parametrize("limit", [0, 2, 2.5, 2**53 + 1, -(2**62) + 1, 1e19])
@pytest.mark.parametrize("kind", ["int", "real"])
def test_rows_in_which_no_comparison_changes_are_those_that_are_passed_over(kind, limit):
    required = "".join(
        f"requirement R{n}\n  always x {op} {limit}\n" for n, op in enumerate(("<", "<=", "=="))
    )
    spec = rvmon.loads(f"spec s\nsignal x : {kind}\n{required}")
    rng = random.Random(kind)
    near = [min(round(limit), 2**63 - 9) + step for step in range(-4, 5)]
    dtype = np.int64 if kind == "int" else np.float64
    x = np.array([rng.choice(near) for _ in range(70) for _ in range(rng.randint(1, 3))], dtype)
    rows = spec.evaluate({"t_ns": np.arange(len(x)), "x": x})
    steps = spec.evaluate([(t * 1e-9, {"x": one.item()}) for t, one in enumerate(x)])
    assert outcomes(rows) == outcomes(steps)
