"""Recordings in rows that the core judges."""

import random

import numpy as np
import pytest
from tests.tools.compare import differences, outcomes
from tests.tools.differential import cases_of
from tests.tools.drive import drive
from tests.tools.each import each
from tests.tools.forms import FORMS, Compiler, Maker
from tests.tools.random_specs import with_few_news

import rvmon
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile


def spec_of(declared: str, required: str) -> rvmon.Spec:
    return rvmon.loads(f"spec s\n{declared}\nrequirement R1\n  {required}\n")


DECLARED = """signal x : real
signal n : int
signal b : bool
signal mode : {red, green}
event e
event pay(k: int, m: {low, high})"""


WRONG = {
    "x": ["9", True, [1.0], 1j],
    "n": [1.5, True],
    "b": [2, "yes"],
    "mode": ["blue", 1],
    "e": [5, 0.5, "no", ""],
    "pay": [{"zz": 3}, {"k": 1.5}, {"m": "none"}],
}


@each(("name", "value"), [(name, one) for name, values in WRONG.items() for one in values])
def test_a_value_of_the_wrong_type_in_a_column_is_refused(name, value):
    spec = spec_of(DECLARED, "always (x < 5 or n > 2 or b or mode == red or e or pay.k > 2)")
    trace = {"t": [0.0, 1.0], name: [None, value]}
    with pytest.raises(rvmon.TraceError, match=rf"sample at 1 s: .*`{name}"):
        spec.evaluate(trace, allow_missing=True)


@pytest.mark.law
def test_long_recordings_are_judged_alike_by_rows_and_by_samples():
    """The core skips rows in which nothing changes; an outage ends a block of rows."""
    compiler, judged = Compiler(), 0
    traces = TraceProfile(samples=300, fewest=100, span=900, outages=20)
    for seed in range(12):
        rng = random.Random(f"long {seed}")
        for case in cases_of(f"long/{seed}", Profile(many=8, wide=10), traces, 3):
            for one in (case, with_few_news(rng, case)):
                steps, rows = (drive(Maker(form, compiler)(one), one)[0] for form in FORMS)
                assert differences(steps, rows) == [], seed
                judged += len(one.samples)
    assert judged > 5_000


@pytest.mark.parametrize("limit", [0, 2, 2.5, 2**53 + 1, -(2**62) + 1, 1e19])
@pytest.mark.parametrize("kind", ["int", "real"])
def test_no_row_that_changes_a_comparison_is_skipped(kind, limit):
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
