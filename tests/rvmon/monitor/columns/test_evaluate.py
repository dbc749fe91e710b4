"""Requirements judged by arrays: the report of a monitor, in any blocks, without an object each."""

import pickle
from itertools import pairwise

import numpy as np
import pytest
from tests.tools.filled import BlockRecording

import rvmon
from rvmon.monitor.columns import drive
from rvmon.monitor.columns.records import JudgedAttempts
from rvmon.monitor.engines import auto
from rvmon.readers.blocks import Block
from rvmon.readers.source import Source

SPEC = """
spec watch "A base"
time {time}
signal p : bool
signal q : bool
signal speed : real
event stop
requirement R1 "an episode per stretch, a window that slides"
  whenever p
  then within 900 ms q
requirement R2 "the past, with both bounds"
  upon rise(once[300 ms, 800 ms] stop)
  then for 400 ms speed < 0.8
requirement R3 "one attempt with many moves"
  upon start
  then always (p -> p until[100 ms, 2 s] q)
requirement R4 "at every stop"
  upon stop
  then (historically[0, 1 s] not q) or eventually (speed > 0.95)
"""


def recording(seed: int, rows: int = 1500) -> dict[str, np.ndarray]:
    """Truth values that stay for a while, a stop now and then, numbers that are lost at times."""
    rng = np.random.default_rng(seed)
    speed = rng.random(rows)
    speed[rng.random(rows) < 0.02] = np.nan

    def slow(stays: int) -> np.ndarray:
        return np.repeat(rng.random(rows // stays + 1) < 0.4, stays)[:rows]

    return {
        "t_ns": np.cumsum(rng.choice([1, 50_000_000, 250_000_000, 1_100_000_000], rows)),
        "p": slow(6),
        "q": slow(4),
        "speed": speed,
        "stop": rng.random(rows) < 0.05,
    }


def of_a_monitor(spec: rvmon.Spec, columns: dict[str, np.ndarray], end: int) -> rvmon.Report:
    """The report of the slow way."""
    monitor = spec.monitor()
    names = [name for name in columns if name != "t_ns"]
    for t, *values in zip(*(columns[n].tolist() for n in ("t_ns", *names)), strict=True):
        monitor.step_ns(t, dict(zip(names, values, strict=True)))
    return monitor.finish_ns(end)


@pytest.mark.law
@pytest.mark.parametrize("few", [0, 12, 10_000])
@pytest.mark.parametrize("time", ["held", "sampled"])
def test_blocks_of_any_size_say_what_a_monitor_says(time, few, monkeypatch):
    """Verdicts, instants, reasons and health, with attempts driven together or one by one."""
    monkeypatch.setattr(drive, "_FEW", few)
    spec = rvmon.loads(SPEC.format(time=time))
    columns = recording(1)
    end = int(columns["t_ns"][-1]) + 2_500_000_000
    expected = of_a_monitor(spec, columns, end)
    names = [name for name in columns if name != "t_ns"]
    for size in (7, 400, 5000):
        blocks = [
            Block(columns["t_ns"][at : at + size], {n: columns[n][at : at + size] for n in names})
            for at in range(0, 1500, size)
        ]
        report = spec.judge(Source(BlockRecording(blocks), end))
        assert isinstance(report.attempts, JudgedAttempts)
        assert [*report.attempts] == [*expected.attempts]
        assert report == expected
    assert {"P", "F", "I"} <= {attempt.verdict for attempt in expected.attempts}


@pytest.mark.slow
def test_what_arrays_cannot_judge_is_judged_beside_them():
    """Captured values make a monitor see each row; what needs two clocks only those that matter."""
    more = """
requirement R5 "two windows at once"
  upon stop
  then within 700 ms (p and for 300 ms q)
requirement R0 "before those"
  upon rise(q)
  then within 1 s not q
"""
    spec = rvmon.loads(SPEC.format(time="held") + more)
    columns = recording(2)
    report = spec.evaluate(columns, time="t_ns")
    assert isinstance(report.attempts, JudgedAttempts)
    assert report == of_a_monitor(spec, columns, int(columns["t_ns"][-1]))
    assert report.counts["R5"]["P"] > 0


def test_attempts_are_a_sequence_and_survive_a_pickle():
    """They can be indexed, cut, compared and sent to another process."""
    report = rvmon.loads(SPEC.format(time="held")).evaluate(recording(3), time="t_ns")
    attempts = report.attempts
    assert attempts[0] == attempts[:1][0] == next(iter(attempts))
    assert attempts[-1].reason
    assert len(attempts[3:8:2]) == 3
    assert pickle.loads(pickle.dumps(report)) == report  # noqa: S301 - just made
    assert attempts != attempts[1:]


def test_whole_numbers_beyond_doubles_are_judged_one_by_one():
    """What arrays would round is left to Python's own numbers."""
    spec = rvmon.loads("spec s\nsignal n : int\nrequirement R1\n  always n > 9007199254740992\n")
    columns = {"t": np.arange(2000.0), "n": np.repeat([2**53 + 1, 2**53], 1000)}
    report = spec.evaluate(columns)
    assert [attempt.decided for attempt in report.attempts] == [1_000_000_000_000]


@pytest.mark.slow
def test_few_rows_are_judged_as_many_are():
    """The report is the same on both sides of the number from which on arrays are used."""
    spec = rvmon.loads(SPEC.format(time="held"))
    for rows in (auto.FEW_ROWS - 1, auto.FEW_ROWS):
        columns = recording(4, rows)
        report = spec.evaluate(columns, time="t_ns")
        assert isinstance(report.attempts, JudgedAttempts) is (rows == auto.FEW_ROWS)
        assert report == of_a_monitor(spec, columns, int(columns["t_ns"][-1]))


@pytest.mark.parametrize("end", [None, 5.0])
def test_no_row_is_no_trace(end):
    """Empty columns trigger nothing."""
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
    report = spec.evaluate({"t": np.empty(0), "p": np.empty(0, bool)}, until=end)
    assert report.verdicts == {"R1": "I"}


def test_many_attempts_are_shown_in_short():
    """Showing a report makes the first attempts alone, and says how many there are."""
    report = rvmon.loads(SPEC.format(time="held")).evaluate(recording(3), time="t_ns")
    shown = repr(report.attempts)
    assert shown.startswith(f"<{len(report.attempts)} attempts: {report.attempts[0]!r}, ")
    assert shown.endswith(f"{report.attempts[2]!r}, …>")
    assert shown in repr(report)
    few = rvmon.loads("spec s\nsignal speed : real\nrequirement R1\n  always speed < 2\n")
    columns = recording(3)
    attempts = few.evaluate(columns, time="t_ns").attempts
    assert repr(attempts) == f"<1 attempt: {attempts[0]!r}>"


UNKNOWN = {
    "before it is asked for": (
        [0, 1, 3],
        [None, 5.0, None],
        "was not known from 3 ns to 20 ns: NaN at 3 ns",
    ),
    "until it is asked for, and on": ([0, 1], [None, None], "had no value before 20 ns"),
    "in a window that does not count, and in one that does": (
        [0, 1, 2, 4, 5],
        [5.0, None, 5.0, 5.0, None],
        "was not known from 5 ns to 20 ns: NaN at 5 ns",
    ),
    "twice when it is asked for": (
        [0, 3, 4, 5],
        [5.0, None, 5.0, None],
        "was not known from 3 ns to 4 ns: NaN at 3 ns",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("size", [4, 2000])
@pytest.mark.parametrize("case", UNKNOWN)
def test_what_left_an_attempt_open_is_told_with_its_stretch(case, size):
    """The stretch in which the unknown made a difference is named, not one before."""
    instants, values, told = UNKNOWN[case]
    spec = rvmon.loads(
        "spec s\nsignal x : real\nevent e\nrequirement R1\n  upon e\n  then G[3 ns, 8 ns] x > 1\n"
    )
    t = np.append(instants, np.arange(20, 1520))
    x = np.append([np.nan if value is None else value for value in values], np.full(1500, 5.0))
    columns = {"t_ns": t, "x": x, "e": t == 0}
    blocks = [
        Block(t[at : at + size], {name: columns[name][at : at + size] for name in ("x", "e")})
        for at in range(0, len(t), size)
    ]
    report = spec.judge(Source(BlockRecording(blocks)))
    assert isinstance(report.attempts, JudgedAttempts)
    assert report.attempts[0].reason == f"left open by the input: `x` {told}"
    assert report == of_a_monitor(spec, columns, int(t[-1]))


@pytest.mark.parametrize("engine", ["auto", "python", "automaton"])
def test_what_was_not_updated_is_told_with_its_stretch(engine):
    """A value is stale a tick after the time that it is given, until the next row."""
    spec = rvmon.loads(
        "spec s\ntime held\nsignal x : real stale after 3 ns\nevent e\n"
        "requirement R1\n  upon e\n  then G[5 ns, 8 ns] x > 1\n"
    )
    t = np.append([0, 1], np.arange(20, 2018))
    columns = {"t_ns": t, "x": np.full(2000, 5.0), "e": t == 0}
    [attempt] = spec.evaluate(columns, engine=engine).attempts
    told = "`x` was not known from 4 ns to 20 ns: no update for 3 ns (stale)"
    assert attempt.reason == f"left open by the input: {told}"


@pytest.mark.parametrize("engine", ["columns", "python", "automaton"])
def test_an_attempt_in_doubt_tells_why_its_trigger_was_not_known(engine):
    """It is that which left it open, whatever is owed."""
    spec = rvmon.loads(
        "spec s\nsignal v : real\nsignal w : real\nevent far\n"
        "requirement R1\n  upon v > 1\n  then eventually w > 1\n"
        "requirement R2\n  upon far\n  then w < 5\n  at end strong\n"
    )
    v, w = np.zeros(2000), np.zeros(2000)
    v[2:4] = np.nan
    columns = {"t_ns": np.arange(2000), "v": v, "w": w}
    report = spec.evaluate(columns, engine=engine, allow_missing=["far"])
    told = {attempt.name: attempt.reason.split("deadline; ")[1] for attempt in report.attempts}
    assert told == {
        "R1?1": "`v` was not known from 2 ns to 4 ns: NaN at 2 ns",
        "R2?1": "`far` has no source",
    }


@pytest.mark.parametrize("engine", ["columns", "python", "automaton"])
def test_what_makes_no_difference_in_the_end_left_nothing_open(engine):
    """Where the run that takes the unknown for the worse meets the other, that is forgotten."""
    spec = rvmon.loads(
        "spec s\nsignal p : bool\nsignal v : real\n"
        "requirement R1\n  upon start\n  then always (v > 1 -> within 5 ns p)\n  at end strict\n"
    )
    v, p = np.zeros(2000), np.zeros(2000, bool)
    v[3], p[5], v[1998] = np.nan, True, 2
    columns = {"t_ns": np.arange(2000), "v": v, "p": p}
    report = spec.evaluate(columns, engine=engine)
    assert [attempt.verdict for attempt in report.attempts] == ["I"]
    assert "not known" not in report.attempts[0].reason


@pytest.mark.slow
@pytest.mark.parametrize("rows", [5, 5000])
def test_each_stretch_of_excess_is_a_failure_in_any_blocks(rows):
    """An episode goes on after a failure, however many there are, and over borders of blocks."""
    spec = rvmon.loads("spec s\nsignal v : real\nrequirement R1\n  always v <= 1\n")
    values = np.tile([0.0, 0.0, 2.0, 2.0, 0.0], 1000)
    times = np.arange(5000) * 1_000_000
    blocks = [
        Block(times[at : at + rows], {"v": values[at : at + rows]}) for at in range(0, 5000, rows)
    ]
    report = spec.judge(Source(BlockRecording(blocks)))
    assert isinstance(report.attempts, JudgedAttempts)
    assert report.counts["R1"] == {"P": 1, "F": 1000, "I": 0}
    failed = [attempt for attempt in report.attempts if attempt.verdict == "F"]
    assert [attempt.number for attempt in failed] == [*range(1, 1001)]
    assert [attempt.decided for attempt in failed] == times[values > 1][::2].tolist()


def test_a_missing_heartbeat_fails_once_per_deadline():
    """Failures at regular distances, where no row is, are those of the law."""
    spec = rvmon.loads("spec s\ntime held\nevent beat\nrequirement R1\n  always within 3 ms beat\n")
    columns = {"t_ns": np.arange(2000) * 1_000_000, "beat": np.zeros(2000, bool)}
    report = spec.evaluate(columns, time="t_ns")
    failed = [attempt for attempt in report.attempts if attempt.verdict == "F"]
    assert isinstance(report.attempts, JudgedAttempts)
    assert {b.triggered - a.triggered for a, b in pairwise(failed)} == {3_000_002}
    assert len(failed) == 666


def test_what_was_lost_hides_triggers_and_what_was_not_born_hides_none():
    """Attempts in doubt have their own numbers; nothing passes before all was born."""
    spec = rvmon.loads(
        "spec s\nsignal v : real\nsignal w : real\nrequirement R1\n  upon v > 1\n  then w > 0\n"
        "requirement R2\n  always w > 0\nrequirement R3\n  upon w > 5\n  then v > 0\n"
    )
    v = np.zeros(2000)
    v[:100], v[300:320], v[500:600] = np.nan, np.nan, 2
    columns = {"t_ns": np.arange(2000) * 1_000_000, "v": v, "w": np.full(2000, np.nan)}
    report = spec.evaluate(columns, time="t_ns")
    assert isinstance(report.attempts, JudgedAttempts)
    assert report.verdicts == {"R1": "I", "R2": "I", "R3": "I"}
    names = {attempt.name for attempt in report.attempts}
    assert names == {"R1#1", "R1?1", "R2#1"}


def test_attempts_follow_failures_before_time_zero() -> None:
    """An episode goes on after a failure at instants below zero as at others."""
    spec = rvmon.loads(
        "spec s\nsignal q : bool\nsignal p : bool\nrequirement R1\n  whenever q\n  then p\n"
    )
    columns = {
        "t_ns": np.array([-3, -2, -1, 2]),
        "q": np.array([True] * 4),
        "p": np.array([False, True, False, True]),
    }
    report = spec.evaluate(columns, engine="columns")
    assert [attempt.triggered for attempt in report.attempts] == [-3, -2, 2]
    assert report.attempts == of_a_monitor(spec, columns, 2).attempts


def test_names_that_end_in_nul_are_told_whole():
    """Arrays of text would leave the end out: the report reads back with all requirements."""
    names = ["a\x00", "b\x00\x00"]
    text = "".join(
        f"requirement `{name}`\n  whenever p\n  then within 900 ms q\n" for name in names
    )
    spec = rvmon.loads(f"spec s\nsignal p, q : bool\n{text}")
    found = recording(1)
    report = spec.evaluate({name: found[name] for name in ("t_ns", "p", "q")})
    assert isinstance(report.attempts, JudgedAttempts)
    read = rvmon.Report.from_json(report.to_json())
    assert read.counts == report.counts
    assert list(read.verdicts) == names
