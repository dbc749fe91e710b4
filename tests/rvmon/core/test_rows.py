"""Recordings that the core judges: as the law has it, what is refused, what is missing."""

import math
import random

import numpy as np
import pytest
from tests.rvmon.core.tables import planned_for, random_table, rows_differ
from tests.tools.compare import differences
from tests.tools.forms import Compiler
from tests.tools.law import judge

import rvmon
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample


def spec_of(declared: str, required: str) -> rvmon.Spec:
    """A specification of one requirement."""
    return rvmon.loads(f"spec s\n{declared}\nrequirement R1\n  {required}\n")


def by_the_law(spec: rvmon.Spec, columns: dict[str, np.ndarray], ticks: np.ndarray) -> rvmon.Report:
    """What the oracle says of the rows, one by one."""
    names = [name for name in columns if name in spec.checked.signals]
    values = zip(*(columns[name].tolist() for name in names), strict=True)
    samples = (
        Sample(t, dict(zip(names, row, strict=True)))
        for t, row in zip(ticks.tolist(), values, strict=True)
    )
    return judge(Case(spec.checked, tuple(samples), None, frozenset(names)))


def test_what_was_met_is_carried_on_over_many_rows():
    """Rows are looked at 64 at once: what an operator of the past knows goes on from there."""
    spec = spec_of("signal p, q, r : bool", "whenever r then immediately q since p")
    rows = np.arange(170)
    trace = {"t": rows * 1e-9, "p": rows % 90 == 30, "q": rows % 90 != 20, "r": rows % 7 == 0}
    report = spec.evaluate(trace)
    assert differences(by_the_law(spec, trace, rows), report) == []
    assert {one.verdict.value for one in report.attempts} == {"P", "F"}


def test_a_whole_number_without_a_column_is_unknown():
    """Nothing is looked at of a column that is not there."""
    spec = spec_of("signal n : int", "upon start then for 2 s (n + 1 < 3)")
    table = {"t": np.array([0.0, 5.0])}
    assert spec.evaluate(table, allow_missing=["n"]).verdicts == {"R1": "I"}


DECLARED = """signal x : real
signal n : int
signal b : bool
signal mode : {red, green}
event e
event pay(k: int, m: {low, high})"""


@pytest.mark.parametrize(
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
@pytest.mark.parametrize("form", ["columns", "samples"])
def test_values_of_another_type_are_refused(name, value, form):
    """What is of no type is told with the sample and the name, not judged."""
    spec = spec_of(DECLARED, "always (x < 5 or n > 2 or b or mode == red or e or pay.k > 2)")
    if form == "columns":
        trace = {"t": [0.0, 1.0], name: [None, value]}
    else:
        trace = [(0.0, {}), (1.0, {name: value})]
    with pytest.raises(rvmon.TraceError, match=rf"sample at 1 s: .*`{name}"):
        spec.evaluate(trace, allow_missing=True)


def test_lengths_of_vectors_are_those_of_python():
    """`hypot` gives the number that Python computes, to the last bit."""
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.random(3000), [0.0, 3e200, 1e-200, 1.0, 1e308]])
    y = np.concatenate([np.round(rng.normal(0, 9, 3000), 2), [0.0, 4e200, 3e-200, 1e-9, 1.0]])
    trace = {"t": np.arange(len(x)), "x": x, "y": y}
    trace["h"] = np.array(list(map(math.hypot, x.tolist(), y.tolist())))
    spec = spec_of("signal x, y, h : real", "always hypot(x, y) == h")
    assert spec.evaluate(trace).verdicts == {"R1": "P"}
    unknown = {"t": np.arange(2), "x": np.array([np.inf, 1e308]), "y": np.array([1.0, 1.7e308])}
    spec = spec_of("signal x, y : real", "upon start\n  then within 1 s hypot(x, y) > 5")
    assert spec.evaluate(unknown).verdicts == {"R1": "I"}


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


@pytest.mark.parametrize("required", ["delta(x) < 1", "changed(x) -> p", "updated(x) -> p"])
def test_each_row_is_an_update(required):
    """No row is passed over where an update counts that changes nothing."""
    spec = spec_of("signal p : bool\nsignal x : real", f"always ({required})")
    rows = np.arange(150)
    trace = {"t_ns": rows, "p": rows % 100 > 0, "x": np.floor(rows / 50) ** 2}
    report = spec.evaluate(trace)
    assert differences(by_the_law(spec, trace, rows), report) == []
    assert any(one.verdict == "F" for one in report.attempts)


@pytest.mark.law
def test_rows_equal_steps():
    """Blocks of rows are judged as the samples that they hold, one by one."""
    compiler = Compiler()
    judged = 0
    for seed in range(12):
        rng = random.Random(f"rows equal steps {seed}")
        spec = random_spec(rng, Profile(many=8, wide=10))
        planned = planned_for(spec, compiler)
        for _ in range(4):
            table = random_table(rng, spec, planned.single_payloads, 200)
            assert not rows_differ(planned, spec, table), f"seed {seed}"
            judged += len(table.rows)
    assert judged > 2_000
