"""`spec.prepare()` and `rvmon prepare`: what is compiled ahead, and taken without a compiler."""

import json

import numpy as np
import pytest

import rvmon
from rvmon.cli import main
from rvmon.monitor.c.prepare import Prepared
from rvmon.monitor.compiled.refusal import of_prepared_margins
from rvmon.monitor.measure_in_c import CompiledRobustnessMonitor
from rvmon.monitor.robustness.monitor import RobustnessMonitor

pytestmark = pytest.mark.compiler

SPEC = "spec s\nsignal p : bool\nrequirement R1\n  always p\nrequirement R2\n  upon p then p\n"
USES = ["auto", "streams", "columns", "robustness"]
TRACE = {"t": [0.0, 1.0], "p": [True, False]}


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A cache in which the specification is prepared."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        patch.delenv("RVMON_CACHE", raising=False)
        told = []
        found = rvmon.loads(SPEC).prepare(ready=told.append, robustness=True)
        assert [one.use for one in found] == USES
        assert tuple(told) == found
        assert all(one.size == one.path.stat().st_size for one in found)
    return folder


@pytest.fixture(autouse=True)
def no_compiler(home, monkeypatch):
    """From now on none is found."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(home))
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    monkeypatch.setenv("CC", "no-such-compiler")


def test_what_is_prepared_needs_no_compiler(tmp_path, capsys):
    """Streams and columns are judged by what lies in the cache."""
    spec = rvmon.loads(SPEC)
    assert spec.evaluate(TRACE, engine="c").verdicts == {"R1": "F", "R2": "P"}
    monitor = spec.monitor(engine="c")
    monitor.step(0.0, {"p": True})
    monitor.step(1.0, {"p": False})
    assert monitor.finish().verdicts["R1"] == "F"
    (tmp_path / "s.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("t,p\n0,1\n1,0\n")
    words = [str(tmp_path / name) for name in ("s.rv", "a.csv")]
    assert main(["run", *words, "--engine", "c", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["requirements"]["R1"]["verdict"] == "F"


def test_what_is_not_prepared_is_told(capsys, tmp_path):
    """Of other requirements nothing is ready, and no compiler to make it."""
    with pytest.raises(rvmon.RvmonError, match=r"no C compiler found .no-such-compiler"):
        rvmon.loads(SPEC).prepare(only=["R1"])
    (tmp_path / "s.rv").write_text("spec s\nsignal p : bool\nrequirement R1\n  always not p\n")
    assert main(["prepare", str(tmp_path / "s.rv")]) == 2
    assert "install one, or name it with CC=" in capsys.readouterr().err


@pytest.mark.parametrize("form", ["text", "json"])
def test_the_command_says_what_is_ready(form, tmp_path, capsys):
    """A line for each file: what for, how long it took, how large it is, and where."""
    (tmp_path / "s.rv").write_text(SPEC)
    assert main(["prepare", str(tmp_path / "s.rv"), "--robustness", "--format", form]) == 0
    told = capsys.readouterr().out
    if form == "json":
        assert [one["use"] for one in json.loads(told)] == USES
        assert all(one["path"].startswith(str(tmp_path.parent)) for one in json.loads(told))
    else:
        head, *lines = told.splitlines()
        assert head.split() == ["for", "took", "size", "file"]
        assert [line.split("  ")[0] for line in lines] == USES


def test_the_command_says_what_auto_does_not_take(tmp_path, capsys, monkeypatch):
    """Each requirement that stands in the way, and why."""
    found = (Prepared("streams", tmp_path / "s.so", 1000, 0.1),)
    monkeypatch.setattr(rvmon.Spec, "prepare", lambda *_, **__: found)
    more = "requirement R9\n  upon p then within 3 s x > a let a = x\n"
    text = f"spec s\nsignal p : bool\nsignal x : real\nrequirement R1\n  always p\n{more}"
    (tmp_path / "s.rv").write_text(text)
    assert main(["prepare", str(tmp_path / "s.rv")]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[-2:] == ["auto judges 1 of 2 requirements in C; in Python:", "  R9: uses `let`"]


def test_a_requirement_that_c_refuses_is_named(tmp_path, capsys):
    """With what to do: leave it out."""
    text = "spec s\ntime sampled\nmax delay 1 s\nsignal p : bool\nrequirement R1\n  always p\n"
    with pytest.raises(rvmon.RvmonError, match=r"R1 has samples that come late.*leave out"):
        rvmon.loads(text).prepare()


def test_auto_takes_what_is_compiled_and_gives_reasons():
    """In streams; which engine it was is said, and nothing else tells them apart."""
    spec = rvmon.loads(SPEC)
    monitor = spec.monitor()
    for t in range(6):
        monitor.step(float(t), {"p": t % 3 > 0})
    report = monitor.finish()
    assert report.engine == monitor.judged_by == "c"
    assert all(attempt.reason for attempt in report.attempts)


def test_auto_measures_by_what_is_compiled(monkeypatch):
    """The figures of each call are those of Python, also of values that are lost."""
    spec = rvmon.loads(SPEC)

    def figures():
        monitor = spec.robustness_monitor(streams=True)
        values = (True, None, False, True)
        found = [list(monitor.step(float(t), {"p": value})) for t, value in enumerate(values)]
        return type(monitor), [*found, list(monitor.open), list(monitor.finish(9.0))]

    ready, ours = figures()
    monkeypatch.setattr("rvmon.monitor.c.notes._maker", lambda: "another version")
    spec = rvmon.loads(SPEC)
    python, theirs = figures()
    assert (ready, python) == (CompiledRobustnessMonitor, RobustnessMonitor)
    assert ours == theirs


def test_auto_measures_columns_by_what_is_compiled(monkeypatch):
    """It is no other figure, and needs no arrays."""
    spec = rvmon.loads(SPEC)
    trace = {name: np.array(column) for name, column in TRACE.items()}
    with monkeypatch.context() as patch:
        patch.setattr("rvmon.monitor.measure._by_columns", None)
        ours = spec.robustness(trace)
    monkeypatch.setattr("rvmon.monitor.measure._is_prepared", lambda *_: False)
    theirs = spec.robustness(trace)
    assert ours.attempts == theirs.attempts
    assert {n: [*one] for n, one in ours.streams.items()} == {
        n: [*one] for n, one in theirs.streams.items()
    }


@pytest.mark.parametrize("kind", ["int", "real"])
def test_auto_measures_whole_numbers_in_python(kind):
    """Doubles do not hold all of them."""
    spec = rvmon.loads(f"spec s\nsignal x : {kind}\nrequirement R\n  always x > 1\n")
    refusal = of_prepared_margins(spec._compiled.requirements["R"])
    assert (refusal is not None) == (kind == "int")


def test_what_auto_cannot_take_is_left_to_python():
    """As with sources that are absent, or samples that come in portions."""
    spec = rvmon.loads(SPEC)
    assert spec.monitor(settle="next").judged_by == "python"
    assert spec.monitor(sources=[]).judged_by == "python"
    assert spec.monitor(only=["R1"]).judged_by == "python"
