"""Wrong use of the Python interface raises an error of rvmon with cause and fix."""

import functools
import re

import numpy as np
import pytest
from tests.tools.each import each

import rvmon
from rvmon.errors import RvmonError, SnapshotError, TraceError, UnknownNameError
from rvmon.live import Live, LiveTasks

DOOR = """
spec door
signal closed : bool
signal gap : real
event knock
requirement D1
  upon knock
  then within 2 s not closed
requirement D2
  always gap < 3
"""


@pytest.fixture
def spec():
    return rvmon.loads(DOOR)


@each(
    "stamps",
    [np.array([0.2, 1.9]), np.array([0.0, np.nan]), [0, "1"], [0, None], [False, True], [0, 2e30]],
)
def test_stamps_that_are_no_whole_number_of_ticks_are_refused(spec, stamps):
    with pytest.raises(TraceError, match=r"whole number of nanoseconds|out of range"):
        spec.evaluate({"t_ns": stamps, "gap": np.array([1.0, 5.0])}, time="t_ns", only=["D2"])


def test_whole_floats_are_ticks_and_numpy_numbers_seconds(spec):
    table = {"t_ns": np.array([0.0, 2.0]), "gap": np.array([1.0, 5.0])}
    [attempt] = spec.evaluate(table, time="t_ns", only=["D2"]).attempts
    assert (attempt.verdict.value, attempt.decided) == ("F", 2)
    monitor = spec.monitor(only=["D2"])
    monitor.step(np.float32(0.5), {"gap": np.float32(1)})
    [attempt] = monitor.step(np.int64(100_000_000), {"gap": 5.0})
    assert attempt.decided == 10**17


@each(
    ("t", "values", "message"),
    [
        ("a", {}, "time 'a' is not a finite number"),
        (None, {}, "time None is not a finite number"),
        (float("inf"), {}, "not finite"),
        (np.float32("nan"), {}, "not finite"),
        (2, {"gap": np.array([1.0, 2.0])}, "`gap`: expected a number, found array"),
        (2, {"closed": [True]}, "`closed`: expected True or False"),
        (2, 5, "expected values by name, found 5"),
        (2, None, "expected values by name, found None"),
    ],
)
def test_a_wrong_sample_is_refused(spec, t, values, message):
    monitor = spec.monitor()
    for _ in range(2):
        with pytest.raises(TraceError, match=message):
            monitor.step(t, values)
        monitor.reset()
        monitor.step(0, {"gap": 1.0})


@each("true", [1, 1.0, np.int8(1), np.True_])
def test_a_monitor_takes_the_same_values_as_recordings(spec, true):
    samples = [(0, {"closed": true, "knock": true, "gap": 1}), (5, {"closed": 1 - int(true)})]
    monitor = spec.monitor()
    told = [attempt.decided for t, values in samples for attempt in monitor.step(t, values)]
    report = monitor.finish()
    assert told == [2_000_000_001]
    assert report.verdicts == spec.evaluate(samples).verdicts == {"D1": "F", "D2": "P"}


@each("trace", [None, 5, [5], [(None, {})], [(0, 5)], [(0,)]])
def test_a_wrong_trace_is_refused(spec, trace):
    with pytest.raises(TraceError, match=r"expected|not a finite number"):
        spec.evaluate(trace)


def test_an_empty_choice_of_requirements_gives_an_empty_report(spec):
    arrays = {"t": np.array([0.0, 2.0]), "gap": np.array([1.0, 5.0])}
    for trace in (arrays, [(0, {"gap": 1.0}), (2, {"gap": 5.0})]):
        report = spec.evaluate(trace, only=[])
        assert (report.verdicts, report.attempts) == ({}, ())


@each("wrong", [1.5, 1.0, "1", b"1", None, [], 1j, 10**400, np.array([1, 2])])
def test_ticks_given_online_are_whole_numbers(spec, wrong):
    monitor = spec.monitor()
    monitor.step_ns(1, {"knock": True, "closed": True})
    ends = () if wrong is None else (monitor.finish_ns,)
    for call in (lambda t: monitor.step_ns(t, {}), monitor.advance_ns, *ends):
        with pytest.raises(TraceError, match=r"not a whole number|out of range") as told:
            call(wrong)
        assert len(str(told.value)) < 200
    assert [attempt.decided for attempt in monitor.advance_ns(5_000_000_000)] == [2_000_000_002]


def test_a_recording_is_no_specification(tmp_path):
    """Its file name shows that arguments were swapped."""
    path = tmp_path / "monday.csv"
    path.write_text("t,x\n0,1\n")
    with pytest.raises(rvmon.SpecError, match=r"monday.csv: a recording by its name"):
        rvmon.load(path)


ONE = [(0, {"gap": 5.0})]
UNKNOWN = "no requirement `Z`: there are D1, D2"
ONE_TEXT = "expected names, such as ['{}'], found one text"


@each(
    ("wrong", "error", "message"),
    [
        (lambda spec: spec.robustness(ONE, only=["Z"]), UnknownNameError, UNKNOWN),
        (lambda spec: spec.evaluate(ONE, only=["Z"]), UnknownNameError, UNKNOWN),
        # A misspelt name would have no attempts.
        (lambda spec: spec.evaluate(ONE).of("Z", "F"), UnknownNameError, UNKNOWN),
        (lambda spec: spec.evaluate(ONE).of("D2", "NT"), UnknownNameError, "the verdict 'NT'"),
        # An undeclared source is most likely a typing error.
        (
            lambda spec: spec.monitor(sources=["gap", "zzz"]),
            UnknownNameError,
            "`zzz`: there are closed, gap, knock",
        ),
        (lambda spec: spec.restore("abc"), SnapshotError, "bytes of a snapshot, found str"),
        # A text is not taken for a list of its letters.
        (lambda spec: spec.monitor(sources="gap"), RvmonError, ONE_TEXT.format("gap")),
        (lambda spec: spec.evaluate([], sources="gap"), RvmonError, ONE_TEXT.format("gap")),
        (lambda spec: spec.evaluate([], only="D1"), RvmonError, ONE_TEXT.format("D1")),
        (lambda spec: Live(spec, only="D1"), RvmonError, ONE_TEXT.format("D1")),
        (
            lambda spec: spec.evaluate({"t": [0], "g": [1.0]}, columns="gap=g"),
            RvmonError,
            "columns='gap=g': expected columns by name",
        ),
        (lambda spec: spec.evaluate([{"t": 0, "gap": 1.0}]), TraceError, "a list of rows by name"),
        # Specifications and constants are text.
        (
            lambda _: rvmon.loads(b"spec door"),
            RvmonError,
            "expected the text of a specification, found bytes",
        ),
        (lambda _: rvmon.loads(None), RvmonError, "found NoneType"),
        (
            lambda _: rvmon.loads("spec door", const={"T": 2}),
            RvmonError,
            "expected a text of the language, such as '2 s'",
        ),
    ],
)
def test_a_wrong_call_is_refused(spec, wrong, error, message):
    with pytest.raises(error, match=re.escape(message)):
        wrong(spec)


def test_attempts_of_a_known_name_and_verdict_are_found(spec):
    assert not spec.monitor(sources=["gap"]).step(0, {"gap": 1.0})
    [failed] = spec.evaluate(ONE).of("D2", rvmon.Verdict.FAIL)
    assert failed.name == "D2#1"


async def _awaited(_):
    """A coroutine, which nobody would await."""


@pytest.mark.parametrize("callback", [_awaited, functools.partial(_awaited), 5])
def test_a_callback_must_be_a_plain_function(spec, callback):
    for registered in (
        spec.monitor().on_failure,
        spec.monitor().on_decided,
        lambda one: Live(spec, on_failure=one),
        lambda one: LiveTasks(spec, on_report=one),
    ):
        with pytest.raises(RvmonError, match="expected a function that takes"):
            registered(callback)
