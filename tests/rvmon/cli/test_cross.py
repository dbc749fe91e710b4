"""`rvmon cross` as a person uses it."""

import json
from dataclasses import replace

import pytest

from rvmon.cli import main
from rvmon.testing import cross
from rvmon.verdict.verdict import Verdict

SPEC = """
spec door
signal closed : bool
signal force : real
event knock
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "No force on a closed door"
  always (closed -> force < 3)
requirement D3
  upon rise(closed)
  then for 3 s force < 5
"""
TRACE = "t,closed,force,knock\n0,1,1,0\n1,1,1,1\n2,0,4,0\n4,1,0,0\n5,1,0,1\n8,1,4,0\n"


@pytest.fixture
def files(tmp_path):
    spec, trace = tmp_path / "door.rv", tmp_path / "monday.csv"
    spec.write_text(SPEC)
    trace.write_text(TRACE)
    return [str(spec), str(trace)]


@pytest.mark.law
def test_every_way_agrees(files, capsys):
    """A table with a row per way and a column per requirement; exit 0."""
    assert main(["cross", *files]) == 0
    shown = capsys.readouterr().out
    for way in ("oracle", "automaton", "progression", "network", "columns", "snapshot"):
        [line] = [line for line in shown.splitlines() if line.strip().startswith(f"{way} ")][:1]
        assert line.split()[1:] == ["=", "=", "="], line


@pytest.mark.slow
def test_json_has_every_answer(files, capsys):
    """Per requirement and way: agreement, or why it was not asked."""
    assert main(["cross", *files, "--only", "D1", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["agree"] is True
    [(name, found)] = document["requirements"].items()
    assert (name, found["verdict"], found["attempts"]) == ("D1", "F", 2)
    assert found["ways"]["oracle"] == {"agrees": True, "differences": []}


@pytest.mark.slow
def test_a_disagreement_is_shown_with_attempt_and_instant(files, capsys, monkeypatch):
    """A way that judges otherwise is named; exit 1."""
    honest = cross._judged

    def crooked(form, case):
        report = honest(form, case)
        if form != "network":
            return report
        flipped = tuple(
            replace(attempt, verdict=Verdict.PASS) if attempt.verdict == "F" else attempt
            for attempt in report.attempts
        )
        return replace(report, attempts=flipped)

    monkeypatch.setattr(cross, "_judged", crooked)
    assert main(["cross", *files, "--only", "D1"]) == 1
    shown = capsys.readouterr().out
    assert "≠ network: D1#2: triggered at 5 s, F at 7.000000001 s" in shown


@pytest.mark.slow
def test_the_oracle_notices_a_wrong_baseline(files, capsys, monkeypatch):
    """The oracle judges by itself, on a case of fewer ticks."""
    honest = cross._judged

    def late(form, case):
        report = honest(form, case)
        moved = tuple(
            attempt if attempt.decided is None else replace(attempt, decided=attempt.decided + 1)
            for attempt in report.attempts
        )
        return replace(report, attempts=moved)

    monkeypatch.setattr(cross, "_judged", late)
    assert main(["cross", *files, "--only", "D1"]) == 1
    assert "≠ oracle: D1#1" in capsys.readouterr().out


@pytest.mark.slow
def test_long_recordings_are_nothing_for_the_oracle(tmp_path, capsys):
    """It says so, and the others are compared."""
    spec, trace = tmp_path / "door.rv", tmp_path / "long.csv"
    spec.write_text(SPEC)
    rows = [f"{t}.{t % 1000:09d},{t % 7 < 3:d},1,{t % 5 == 0:d}" for t in range(60)]
    trace.write_text("t,closed,force,knock\n" + "\n".join(rows) + "\n")
    assert main(["cross", str(spec), str(trace), "--only", "D1"]) == 0
    assert "ticks to lay out" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--only", "D9"], "there are D1, D2, D3"),
        (["--peers", "/nowhere/python"], "--peers /nowhere/python"),
    ],
)
def test_wrong_arguments_are_named(files, capsys, words, message):
    """Exit 2 with place and cause."""
    assert main(["cross", *files, *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_what_comes_too_late_is_left_out_as_run_does(tmp_path, capsys):
    """Both judge the same recording, and it is said what is no part of it."""
    spec, trace = tmp_path / "door.rv", tmp_path / "late.csv"
    spec.write_text("spec door\nmax delay 1 s\nsignal v : real\nrequirement R1\n  always v < 3\n")
    trace.write_text("t,v\n0,1\n2,1\n1.5,2\n5,1\n3,9\n6,1\n")
    files = [str(spec), str(trace)]
    assert main(["run", *files, "--format", "json"]) == 0
    judged = json.loads(capsys.readouterr().out)["requirements"]["R1"]["verdict"]
    assert main(["cross", *files, "--format", "json"]) == 0
    crossed = json.loads(capsys.readouterr().out)
    assert crossed["requirements"]["R1"]["verdict"] == judged == "P"
    assert crossed["left_out"] == 1
    assert main(["cross", *files]) == 0
    assert "later than `max delay`: the sample at 3 s" in capsys.readouterr().out


@pytest.mark.slow
def test_undeclared_columns_are_named(files, capsys, tmp_path):
    """As by `rvmon run`: in the text and in the JSON."""
    (tmp_path / "monday.csv").write_text(TRACE.replace("\n", ",7\n").replace(",7", ",extra", 1))
    assert main(["cross", *files, "--only", "D1"]) == 0
    assert "ignored, not declared in the spec: extra" in capsys.readouterr().out
    assert main(["cross", *files, "--only", "D1", "--format", "json"]) == 0
    [found] = json.loads(capsys.readouterr().out)["health"]
    assert (found["kind"], found["name"]) == ("ignored", "extra")


def test_a_spec_without_requirements_is_an_error(files, capsys, tmp_path):
    """Nothing to compare: exit 2, with the reason."""
    (tmp_path / "door.rv").write_text(SPEC.partition("requirement")[0])
    assert main(["cross", *files]) == 2
    assert "no requirement" in capsys.readouterr().err
