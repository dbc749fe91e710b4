"""Nearest misses, cover goals and notes on failures: found in columns as in all samples."""

import json
import random
from collections import Counter
from pathlib import Path

import pytest

import rvmon
from rvmon.analysis.subformulas import why_not_triggered
from rvmon.cli import post_analysis
from rvmon.cli.evaluation import Options, judge
from rvmon.monitor.notes import NotesReader
from rvmon.recordings import recording
from rvmon.verdicts.report import Report

BASE = Path(__file__).parents[3] / "examples" / "base"
HEAD = """
spec cell
time {time}
signal p, q : bool
signal x : real
event go
"""
SILENT = {
    "values": "p and x > 50",
    "two ways": "(p and q and x > 50) or (go and x < -9)",
    "past": "once[100 ms, 2 s] (p and go) and x > 50",
    "held": "held(p, 1 s) and x > 50",
    "first": "start and x > 50",
    "unlike": "p and not p",
    "updates": "p and updated(q) and x > 50",
    "changes": "changed(x) and x > 50",
    "age": "age(x) > 20 s and p",
}


def rows(seed: int) -> list[dict]:
    """A recording with a change in few of its rows."""
    rng = random.Random(seed)
    t, row, made = 5_000_000_000, {"p": False, "q": True, "x": 0.5, "go": False}, []
    for _ in range(400):
        row = {**row, "go": rng.random() < 0.03}
        if rng.random() < 0.2:
            row["p"], row["q"] = rng.random() < 0.5, rng.random() < 0.5
            row["x"] = rng.choice([0.5, 1.5, -3.0])
        made.append({"t_ns": t, **row})
        t += rng.choice([1, 70_000_000, 800_000_000])
    return made


@pytest.fixture(params=[1, 2])
def traces(request, tmp_path):
    """The same rows as CSV with numbers, as CSV with `true` and `false`, and as JSON lines."""
    found = rows(request.param)
    lines = [",".join(found[0])]
    lines += [
        ",".join(str(float(v) if k == "x" else int(v)) for k, v in row.items()) for row in found
    ]
    (tmp_path / "a.csv").write_text("\n".join(lines) + "\n")
    words = [",".join(str(v).lower() for v in row.values()) for row in found]
    (tmp_path / "b.csv").write_text("\n".join([lines[0], *words]) + "\n")
    (tmp_path / "a.jsonl").write_text("".join(json.dumps(row) + "\n" for row in found))
    return [str(tmp_path / name) for name in ("a.csv", "b.csv", "a.jsonl")]


@pytest.fixture
def read_again(monkeypatch):
    """The recordings that are read a second time."""
    found, opened = [], post_analysis.opened

    def noted(*given, **more):
        found.append(given)
        return opened(*given, **more)

    monkeypatch.setattr(post_analysis, "opened", noted)
    return found


@pytest.mark.law
@pytest.mark.parametrize("until", [None, 60.0])
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 300 ms"])
def test_the_nearest_miss_equals_that_of_all_samples(time, until, traces):
    text = HEAD.format(time=time) + "".join(
        f"requirement R{number}\n  upon {trigger}\n  then within 1 s q\n"
        for number, trigger in enumerate(SILENT.values())
    )
    spec = rvmon.loads(text)
    for trace in traces:
        report = judge(spec, trace, Options(until=until)).report
        samples = [sample for sample in spec.recording(trace) if sample.t <= report.end]
        silent = [name for name, verdict in report.verdicts.items() if verdict == "NT"]
        assert len(silent) > 5
        names = spec.recording(trace).names
        for name in silent:
            requirement = spec.requirements[name]
            wanted = why_not_triggered(spec.checked, requirement, samples, report.end, names)
            assert report.misses[name] == wanted


@pytest.mark.law
@pytest.mark.parametrize("until", [None, 60.0])
def test_goals_equal_those_of_all_samples(until, traces, monkeypatch):
    text = HEAD.format(time="held") + (
        "requirement R1\n  always (p or not p)\n"
        "cover shown = F (p and q and F[1 s, 9 s] go)\n"
        "cover never = F (x > 50)\n"
        "cover open = F (q and G[0 s, 500 s] x < 50)\n"
    )
    spec = rvmon.loads(text)
    by_columns = [judge(spec, trace, Options(until=until)).report for trace in traces]
    monkeypatch.setattr(recording.FileRecording, "pieces", recording.FileRecording.__iter__)
    by_samples = [judge(spec, trace, Options(until=until)).report for trace in traces]
    assert by_columns == by_samples
    assert [list(report.goals.values()) for report in by_columns] == [["P", "I", "I"]] * 3


NOTED_IN_PASSING = {
    "a signal": "q and x > 1",
    "what is false": "not q or x < 0",
    "an update": "updated(x) and not p",
    "what is known": "known(x) and x < -2",
    "nothing that comes": "x > 9",
    "an event": "go",
    "an event with a signal": "go and q",
}
NEEDS_HISTORY = {
    "a change": "changed(x)",
    "the past": "once[0 s, 2 s] (p and go)",
    "a window": "count(go, 3 s) >= 2",
}


@pytest.mark.law
@pytest.mark.parametrize("stale", ["", "stale after 300 ms"])
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 300 ms", "held\nmax delay 1 s"])
@pytest.mark.parametrize("awaited", [NOTED_IN_PASSING, NEEDS_HISTORY])
def test_late_answers_and_values_are_those_of_a_recording_in_memory(
    awaited, time, stale, traces, read_again, monkeypatch
):
    text = HEAD.format(time=time).replace("x : real", f"x : real {stale}") + "".join(
        f"requirement R{number}\n  upon go or p\n  then within 500 ms ({formula})\n"
        for number, formula in enumerate(awaited.values())
    )
    text += "requirement S\n  whenever q\n  then immediately x < 1\n"
    spec = rvmon.loads(text)
    for trace in traces:
        short = judge(spec, trace, Options()).report
        with monkeypatch.context() as patch:
            patch.setattr(post_analysis, "MOST_HELD", 60)
            patch.setattr(post_analysis, "_AT_ONCE", 30)
            patch.setattr("rvmon.recordings.places.BLOCK", 900)
            patch.setattr("rvmon.analysis.arrivals._FEW", 5)
            assert judge(spec, trace, Options()).report == short
        assert short.values["S"]
        assert len(short.late) > 1
    # In clocked time an event counts at the next position, so earlier samples are needed.
    is_again = awaited is NEEDS_HISTORY or time == "sampled every 300 ms"
    assert len(read_again) == (len(traces) if is_again else 0)


def test_the_limit_of_explained_failures_leaves_one_to_each_requirement(put, monkeypatch):
    monkeypatch.setattr("rvmon.cli.failure_notes.MOST_LATE_IN_ALL", 4)
    text = "spec s\nevent e\nsignal p : bool\n" + "".join(
        f"requirement R{n}\n  upon e then within {n + 1} ms p\n" for n in range(9)
    )
    rows = "".join(f"{t},{int(t % 4 == 1)},{int(t % 4 == 3)}\n" for t in range(40))
    report = judge(rvmon.loads(text), put("a.csv", "t,e,p\n" + rows), Options()).report
    assert {name: [*found] for name, found in report.late.items()} == {
        f"R{n}": [1] for n in range(9)
    }


def test_a_trigger_of_instances_hides_no_miss(put):
    text = (
        "spec s\nevent go(k: int)\nsignal p, q : bool\n"
        "requirement R1\n  upon p and q then within 1 s go.k == k\n  for each k in go.k\n"
        "requirement R2\n  upon p and q then within 1 s go\n"
    )
    rows = '{"t": 0, "p": false, "q": false}\n{"t": 1, "p": true}\n{"t": 2, "p": false}\n'
    spec, path = rvmon.loads(text), put("a.jsonl", rows)
    report = judge(spec, path, Options()).report
    assert report.misses == {"R2": "`q` was never true while `p` was (first at 1 s)"}
    assert not judge(spec, path, Options(explains=False)).report.misses


@pytest.mark.parametrize("held", [2, 90])
def test_first_failures_have_the_values_of_their_signals(put, monkeypatch, held):
    """Numbers and states that the failed part reads, with units; no truth values or triggers.

    They are the same when the file has to be read again.
    """
    monkeypatch.setattr(post_analysis, "MOST_HELD", held)
    text = """spec s
signal force : real [N]
signal mode : {idle, busy}
signal ok : bool
signal other : real
requirement R1
upon fall(ok) then immediately (force <= 40 N and mode = idle and other < 3)
"""
    rows = "t,force,mode,ok,other\n0,10,idle,1,1\n1,41.5,busy,0,\n2,,,1,nan\n3,,,0,\n"
    rows += "4,,,1,1\n5,3,idle,0,7\n6,,,1,\n7,50,,0,\n"
    report = judge(rvmon.loads(text), put("a.csv", rows), Options()).report
    assert report.values == {
        "R1": {
            1: {"force": "41.5 N", "mode": "busy", "other": "1"},
            2: {"force": "41.5 N", "mode": "busy", "other": "not known"},
            3: {"force": "3 N", "mode": "idle", "other": "7"},
        }
    }
    assert Report.from_json(report.to_json()).values == report.values


@pytest.mark.parametrize("form", ["text", "json"])
def test_an_attempt_is_explained_once_for_all_outputs(form, tmp_path, monkeypatch, says):
    explained = Counter[str]()
    details = NotesReader.details

    def counting(reader, attempt, note, name):
        explained[attempt.name] += 1
        return details(reader, attempt, note, name)

    monkeypatch.setattr(NotesReader, "details", counting)
    files = {"--out": "out.csv", "--junit": "junit.xml", "--report": "pages"}
    words = [word for option, name in files.items() for word in (option, tmp_path / name)]
    says(1, "run", BASE.with_suffix(".rv"), BASE.with_suffix(".csv"), "--format", form, *words)
    assert explained == {"B1#1": 1, "B2#1": 1, "B2#2": 1}
