"""Columns of arrays: judged as the same samples one by one."""

import ctypes
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from tests.tools.compare import differences
from tests.tools.differential import cases_of
from tests.tools.filled import filled, judge_columns
from tests.tools.law import judge

import rvmon
from rvmon.codegen.c_build import Build, built
from rvmon.monitor import compile_spec
from rvmon.monitor.columns import evaluate as arrays
from rvmon.monitor.engines import row_judge
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

SPEC = """
spec watch "A base"
time {time}
signal p : bool
signal speed : real [m/s]  stale after 400 ms
signal load : real
signal count : int
event stop
event go
requirement R1 "a"
  upon stop
  then within 1 s speed < 0.2 m/s
requirement R2 "b"
  whenever p and once[100 ms, 900 ms] go
  then within 700 ms load * 2 + 1 < 1.5
requirement R3 "c"
  always (count >= 3 -> within 1 s (count < 1 or stop))
requirement R4 "d"
  upon rise(p)
  then within 500 ms (abs(load) > 0.7 or not known(speed))
requirement R5 "e"
  whenever hypot(load, load / 2) > 0.9
  then held(p, 300 ms) or min(load, 0.4) < 0.1 {extra}
"""


def recording(seed: int, rows: int = 3000) -> dict[str, np.ndarray]:
    """Random walks at 20 Hz with gaps, jitter and unknown values."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.choice([0.05, 0.0499999995, 0.6, 3e-9], rows, p=[0.6, 0.3, 0.05, 0.05]))
    speed = np.abs(np.cumsum(rng.normal(0, 0.02, rows)))
    speed[rng.random(rows) < 0.01] = np.nan
    return {
        "t": t,
        "p": np.repeat(rng.random(rows // 10 + 1) < 0.5, 10)[:rows],
        "speed": speed,
        "load": np.round(rng.random(rows), 1),
        "count": np.repeat(rng.integers(0, 5, rows // 7 + 1), 7)[:rows],
        "stop": rng.random(rows) < 0.01,
        "go": rng.random(rows) < 0.05,
        "unheard": np.zeros(rows),
    }


def one_by_one(spec: rvmon.Spec, columns: dict[str, np.ndarray]) -> rvmon.Report:
    """The report of the slow way: lists take it."""
    return spec.evaluate({name: column.tolist() for name, column in columns.items()})


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled every 20 ms", "sampled"])
@pytest.mark.parametrize("extra", ["", "or delta(count) > 2"])
def test_the_report_is_that_of_the_samples(time, extra, monkeypatch):
    """Verdicts, records, reasons and health are the same, whatever rows are passed over."""
    monkeypatch.setattr(arrays, "CHUNK", 517)
    monkeypatch.setattr(row_judge, "CHUNK", 131)
    spec = rvmon.loads(SPEC.format(time=time, extra=extra))
    columns = recording(3)
    slow, fast = one_by_one(spec, columns), spec.evaluate(columns)
    assert fast == slow
    assert {"P", "F"} <= {attempt.verdict for attempt in fast.attempts}
    # Where each row is a position and updates all, nothing is found to be stale at one.
    unknown = {"nan"} if time == "sampled" else {"nan", "stale"}
    assert {entry.kind for entry in fast.health} >= unknown


def test_most_rows_are_passed_over(monkeypatch):
    """A recording that changes nothing costs a look at its arrays."""
    spec = rvmon.loads(SPEC.format(time="held", extra="").replace("stale after 400 ms", ""))
    columns = recording(4) | {"load": np.linspace(0, 0.1, 3000), "p": np.zeros(3000, bool)}
    columns |= {"stop": np.zeros(3000, bool), "go": columns["t"] < 0, "count": np.zeros(3000, int)}
    columns["speed"] = np.linspace(0.3, 0.4, 3000)
    taken = []
    real = row_judge.rows_that_matter
    monkeypatch.setattr(
        row_judge, "rows_that_matter", lambda *a: taken.append(len(found := real(*a))) or found
    )
    report = spec.evaluate(columns, engine="automaton")
    assert report == one_by_one(spec, columns)
    assert sum(taken) < 20


def test_times_are_rounded_as_everywhere():
    """Seconds become ticks one rounding at a time, halves to the even one."""
    rng = np.random.default_rng(5)
    seconds = np.concatenate(
        [rng.random(2000) * 1e9, rng.random(2000), [0.5e-9, 1.5e-9, 2.5e-9, -0.5e-9, 4e6 + 0.3]]
    )
    from rvmon.readers.ticks import ticks_of_column
    from rvmon.trace.stamps import stamps_of
    from rvmon.trace.time import ticks_of_seconds

    exact = [ticks_of_seconds(float(value)) for value in seconds]
    assert ticks_of_column(seconds, stamps_of("t")).tolist() == exact


def test_disorder_and_wrong_columns_are_refused_as_ever():
    """What the arrays do not fit goes the slow way, which names the trouble."""
    spec = rvmon.loads(SPEC.format(time="held", extra=""))
    columns = recording(6, 50)
    with pytest.raises(rvmon.TimeOrderError):
        spec.evaluate(columns | {"t": columns["t"][::-1].copy()})
    with pytest.raises(rvmon.TraceError, match="length"):
        spec.evaluate(columns | {"p": columns["p"][:-1]})
    with pytest.raises(rvmon.TraceError, match="True or False"):
        spec.evaluate(columns | {"p": columns["load"]})


@pytest.mark.compiler
@pytest.mark.parametrize("time", ["held", "sampled every 20 ms", "sampled"])
def test_the_engine_c_agrees(time, tmp_path, monkeypatch):
    """Compiled C gives the same attempts; what it has not are reasons and health."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    spec = rvmon.loads(SPEC.format(time=time, extra="or delta(count) > 2"))
    columns = recording(7)
    slow = one_by_one(spec, columns)
    samples = [
        (float(t), {"p": bool(p), "stop": bool(e)})
        for t, p, e in zip(columns["t"], columns["p"], columns["stop"], strict=True)
    ]
    for expected, report in (
        (slow, spec.evaluate(columns, engine="c")),
        (spec.evaluate(samples), spec.evaluate(samples, engine="c")),
    ):
        assert report.verdicts == expected.verdicts
        assert (report.origin, report.end) == (expected.origin, expected.end)
        assert [bare(one) for one in report.attempts] == [bare(one) for one in expected.attempts]
    assert len(list((tmp_path / "rvmon").glob("*.so"))) == 1


def bare(attempt: rvmon.Attempt) -> rvmon.Attempt:
    """A record without what only the engines of this process say."""
    return replace(
        attempt, reason="", deadline=None, at_trigger={}, at_decision={}, owed="", blame=None
    )


def test_a_cache_that_others_can_write_is_refused(tmp_path, monkeypatch):
    """Nothing is loaded from where someone else could have put it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "rvmon").mkdir()
    (tmp_path / "rvmon").chmod(0o777)
    spec = rvmon.loads(SPEC.format(time="held", extra=""))
    with pytest.raises(rvmon.RvmonError, match=r"written by others|no C compiler"):
        spec.evaluate(recording(8, 20), engine="c")


@pytest.mark.parametrize("jobs", [1, 2])
def test_many_traces_in_one_call(jobs):
    """Each trace gets its own report, in order, whatever the number of processes."""
    spec = rvmon.loads(SPEC.format(time="held", extra=""))
    runs = [recording(seed, 200) for seed in range(3)]
    reports = list(spec.evaluate_many(runs, jobs=jobs, only=["R1", "R3"]))
    assert reports == [spec.evaluate(run, only=["R1", "R3"]) for run in runs]
    assert set(reports[0].verdicts) == {"R1", "R3"}


@pytest.mark.compiler
def test_builds_at_the_same_time_do_not_disturb_each_other(tmp_path, monkeypatch):
    """Whoever comes second finds a whole file; nothing is left over."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    texts = {"one.c": "int one(void);\nint one(void) { return 1; }\n"}

    def build(_: int) -> object:
        return built(Build(texts, ["one.c"], ".so", ["-shared", "-fPIC"]))

    with ThreadPoolExecutor(4) as pool:
        paths = set(pool.map(build, range(8)))
    (path,) = paths
    assert ctypes.CDLL(str(path)).one() == 1
    assert list(path.parent.glob("*.so")) == [path]
    assert not list(path.parent.glob("*.part"))


@pytest.mark.compiler
@pytest.mark.parametrize(("engine", "seeds"), [("auto", 30), ("c", 4)])
def test_columns_judge_as_the_law_has_it(engine, seeds, optimised):
    """Random specifications on random arrays: what the oracle says of the same samples."""
    profile = Profile(captures=False, for_each=False)
    judged = 0
    for seed in range(seeds):
        compiled = None
        for case in map(filled, cases_of(f"columns/{seed}", profile, TraceProfile(), 3)):
            compiled = compiled or compile_spec(case.spec)
            cuts = [len(case.samples) // 3] if len(case.samples) > 3 else []
            report = judge_columns(compiled, case, engine, cuts)
            if report is not None:
                judged += 1
                assert not differences(judge(case), report)
    assert judged >= seeds
