"""Robustness by compiled C: the figures of the monitor in Python."""

import random

import numpy as np
import pytest
from tests.tools.differential import cases_of
from tests.tools.margin_ways import WAYS

import rvmon
from rvmon.errors import RvmonError, TimeOrderError
from rvmon.session import Spec
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.show import show_case

pytestmark = pytest.mark.compiler

SPEC = """
spec reach
time {time}
signal x : real [cm]
signal v : real [m/s]
signal p : bool
event e
requirement R1
  always (x > 5 cm -> within 3 s (v < 2 m/s or p))
requirement R2
  upon e then within 2 s x > 10 cm
requirement R3
  always ((once[1 s, 2 s] e) -> x - 3 cm < 5 cm)
requirement R4
  upon start then (x < 8 cm) U[1 s, 4 s] (v > 1 m/s)
"""


@pytest.fixture(autouse=True)
def compilers(extensions):
    """Extension modules can be compiled here."""


@pytest.fixture(scope="module", params=["held", "sampled"])
def spec(request):
    """The specification above."""
    return rvmon.loads(SPEC.format(time=request.param))


def rows(number, seed=1, lost=0.0):
    """Random samples; some have a signal less, or one that is not known."""
    rng, t = random.Random(seed), 0.0
    for _ in range(number):
        t += rng.choice((0.5, 1, 1, 2.5))
        row = {"x": rng.randint(0, 14), "v": rng.uniform(0, 3), "p": rng.random() < 0.2}
        row["e"] = rng.random() < 0.3
        for name in ("x", "v", "p"):
            if rng.random() < lost:
                row[name] = None
            elif rng.random() < 0.2:
                del row[name]
        yield t, row


@pytest.mark.parametrize("lost", [0.0, 0.2])
@pytest.mark.parametrize("settle", ["now", "next"])
def test_each_call_gives_what_the_monitor_in_python_gives(spec, lost, settle):
    """Figures come at the same calls, in the same order, with the same bounds on the way."""
    ours, theirs = (
        spec.robustness_monitor(streams=True, settle=settle, engine=engine)
        for engine in ("c", "auto")
    )
    for t, row in rows(80, lost=lost):
        assert list(ours.step(t, row)) == list(theirs.step(t, row))
        by_number = {(one.requirement, one.in_doubt, one.number): one for one in ours.open}
        assert by_number == {
            (one.requirement, one.in_doubt, one.number): one for one in theirs.open
        }
        assert list(ours.advance(t + 0.25)) == list(theirs.advance(t + 0.25))
    assert list(ours.finish(t + 9)) == list(theirs.finish(t + 9))


@pytest.mark.law
@pytest.mark.parametrize("time", [TimeModel.HELD, TimeModel.SAMPLED])
def test_random_cases_are_measured_alike(time):
    """C gives each attempt the bounds that Python gives it, by samples and by columns."""
    profile = Profile(time=time, captures=False, for_each=False)
    measured = 0
    for number in range(2):
        for case in cases_of(f"measured by c {number}", profile, TraceProfile(), 8):
            spec = Spec(case.spec)
            found = WAYS["c"].measure(spec, case)
            assert found is None or found == WAYS["samples"].measure(spec, case), show_case(case)
            measured += found is not None
    assert measured > 6


@pytest.mark.parametrize("streams", [True, False])
def test_columns_are_measured_as_by_arrays(spec, streams):
    """A recording in columns has the same figures by C, attempts and streams."""
    rng = np.random.default_rng(3)
    trace = {
        "t": np.cumsum(rng.integers(1, 4, 200)) * 0.5,
        "x": rng.integers(0, 14, 200),
        "v": rng.random(200) * 3,
        "p": rng.random(200) < 0.2,
        "e": rng.random(200) < 0.2,
    }
    ours, theirs = (spec.robustness(trace, streams=streams, engine=e) for e in ("c", "auto"))
    assert ours.attempts == theirs.attempts
    assert {name: [*own] for name, own in ours.streams.items()} == {
        name: [*own] for name, own in theirs.streams.items()
    }


def test_rows_with_what_is_not_known_are_measured_alike(spec):
    """Columns with NaN go through C as they go through the monitor sample by sample."""
    trace = {"t": [0, 1, 2, 3, 9], "x": [9.0, float("nan"), 3.0, 12.0, 1.0], "v": [1.0, 5, 1, 4, 0]}
    trace |= {"p": [False] * 5, "e": [True, False, True, False, False]}
    ours, theirs = (spec.robustness(trace, engine=engine) for engine in ("c", "auto"))
    assert (ours.attempts, ours.doubtful) == (theirs.attempts, theirs.doubtful)


def test_judged_records_have_the_robustness(spec):
    """`engine="c"` with robustness gives each record the figure that `auto` gives it."""
    trace = [*rows(40, seed=5)]

    def figures(engine):
        recording = spec.recording(trace)
        report = spec.judge(rvmon.readers.source.Source(recording), engine=engine, robustness=True)
        return [(one.requirement, one.number, one.robustness) for one in report.attempts]

    assert figures("c") == figures("auto")


def test_what_c_does_not_measure_is_refused_by_name():
    """A requirement with `let` is named, with what to do."""
    spec = rvmon.loads(
        "spec s\nsignal x : real\nevent e\nrequirement R1\n"
        "  upon e then within 2 s x > v\n  let v = x\n"
    )
    with pytest.raises(RvmonError, match=r"R1 uses `let`.*engine `auto`"):
        spec.robustness_monitor(engine="c")


def test_another_engine_is_refused():
    """Only `auto` and `c` measure."""
    spec = rvmon.loads("spec s\nsignal x : real\nrequirement R1\n  always x < 3\n")
    with pytest.raises(RvmonError, match="no engine `network` measures: there are auto, c"):
        spec.robustness_monitor(engine="network")


def test_a_sample_that_is_late_changes_nothing(spec):
    """It raises, and the run goes on as if it had not come."""
    monitor, other = (spec.robustness_monitor(engine="c", streams=True) for _ in range(2))
    found, expected = [], []
    for t, row in rows(20):
        found += monitor.step(t, row)
        expected += other.step(t, row)
        with pytest.raises(TimeOrderError):
            monitor.step(t, row)
    assert found == expected
    assert monitor.finish() == other.finish()
