"""`rvmon why` as a person uses it."""

import json

import pytest
from tests.tools.logs import write_ulog

from rvmon.cli import main

SPEC = """
spec door "A door"
signal closed : bool input
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2
  upon fall(closed)
  then immediately not knock
"""
TRACE = "t,closed,knock\n0,1,\n1,,1\n2,0,\n3,1,\n4,,1\n8,,1\n9,,\n"


@pytest.fixture
def door(tmp_path, monkeypatch):
    """A folder with a spec and a recording: D1 passes, fails, stays open."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "door.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text(TRACE)
    return tmp_path


@pytest.mark.parametrize(
    ("named", "verdict"), [("D1#1", "P"), ("D1#2", "F"), ("D1#3", "I"), ("D1", "F"), ("D2", "P")]
)
def test_attempts_are_shown_with_their_verdict(door, capsys, named, verdict):
    """The attempt named, or the most telling one; no line is wider than 80 columns."""
    assert main(["why", "door.rv", "a.csv", named]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[1] == verdict
    assert all(len(line) <= 80 for line in lines)
    assert any(line.strip() == "required" for line in lines)


def test_an_attempt_in_doubt_has_a_name_of_its_own(door, capsys):
    """`D1?1` is not `D1#1`; both can be asked for, and only what there is."""
    (door / "a.jsonl").write_text(
        '{"t": 0, "closed": true, "knock": true}\n{"t": 1, "knock": null}\n{"t": 9}\n'
    )
    for name, verdict in (("D1#1", "F"), ("D1?1", "I")):
        assert main(["why", "door.rv", "a.jsonl", name]) == 0
        assert capsys.readouterr().out.split()[:2] == [name, verdict]
    assert main(["why", "door.rv", "a.jsonl", "D1?2"]) == 2
    assert "no attempt D1?2: there are D1#1 to D1?1" in capsys.readouterr().err


def test_rows_show_truth_over_the_window(door, capsys):
    """The row of the trigger has its moment, that of the failed part is false to the deadline."""
    assert main(["why", "door.rv", "a.csv", "D1#2"]) == 0
    rows = {line[:34].strip(): line[34:] for line in capsys.readouterr().out.splitlines()}
    assert rows["knock"].count("●") == 1
    assert set(rows["not closed"]) == {"▁"}
    assert rows["within 2 s not closed"][0] == "▁"


def test_signals_are_told_as_they_were(tmp_path, capsys):
    """With unit at the trigger and the end, once where these are one; what is lost is so."""
    (tmp_path / "a.rv").write_text(
        "spec a\nsignal force : real [N] input\nsignal grip : {open, closed} output\n"
        "event go input\nrequirement A1\nupon go then within 1 s (grip = closed and force > 3 N)\n"
        "requirement B1\nupon go then immediately grip = closed\n"
    )
    (tmp_path / "a.csv").write_text(
        "t,force,grip,go\n0,0.30000000000000004,open,1\n0.5,nan,closed,\n3,,,\n"
    )
    paths = [str(tmp_path / "a.rv"), str(tmp_path / "a.csv")]
    assert main(["why", *paths, "A1"]) == 0
    rows = [line.split("  ") for line in capsys.readouterr().out.splitlines()]
    told = [[cell.strip() for cell in row if cell.strip()] for row in rows][-3:]
    assert told == [
        ["values", "at the trigger", "at the end"],
        ["grip", "open", "closed"],
        ["force", "0.3 N", "not known"],
    ]
    assert main(["why", *paths, "B1", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["values"] == {"grip": ["open"]}


def test_the_same_as_data(door, capsys):
    """As JSON: the attempt, the window and the spans of every part."""
    assert main(["why", "door.rv", "a.csv", "D1#1", "--format", "json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["attempt"]["decided"] == 2 * 10**9
    rows = {row["text"]: row for row in shown["part_truths"]}
    assert rows["knock"]["true"] == [[10**9, 10**9]]
    assert rows["not closed"]["true"][0][0] == 2 * 10**9


def test_late_samples_are_put_in_order(tmp_path, capsys):
    """Under `max delay` a recording out of order is taken apart in order."""
    text = SPEC.replace('"A door"\n', '"A door"\nmax delay 5 s\n')
    (tmp_path / "a.rv").write_text(text)
    (tmp_path / "a.csv").write_text("t,closed,knock\n0,1,\n2,0,\n1,,1\n9,,\n")
    assert main(["why", str(tmp_path / "a.rv"), str(tmp_path / "a.csv"), "D1#1"]) == 0
    assert capsys.readouterr().out.startswith("D1#1  P")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["door.rv", "a.csv", "D1#9"], "there are D1#1 to D1#3"),
        (["door.rv", "a.csv", "D9"], "no requirement `D9`"),
        (["door.rv", "a.csv", "D1#x"], "names no attempt"),
        (["door.rv", "none.csv", "D1"], "none.csv"),
        (["none.rv", "a.csv", "D1"], "none.rv"),
        (["door.rv", "-", "D1"], "save the recording"),
        (["door.rv", "b.csv", "D1"], "line 3"),
        (["door.rv", "c.csv", "D1"], "never triggered"),
    ],
)
def test_wrong_words_are_answered_with_a_fix(door, capsys, words, said):
    """One message, exit code 2, no traceback."""
    (door / "b.csv").write_text("t,closed,knock\n0,1,\n1,maybe,\n")
    (door / "c.csv").write_text("t,closed,knock\n0,1,\n1,1,\n")
    assert main(["why", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_requirement_that_was_not_triggered_says_what_lacked(tmp_path, capsys):
    """There is no attempt to show, but there is a nearest miss."""
    spec, trace = tmp_path / "s.rv", tmp_path / "t.csv"
    spec.write_text(
        'spec s\nsignal a, b : bool\nevent e\nrequirement R1 "x"\n'
        "  upon e and a\n  then within 1 s b\n"
    )
    trace.write_text("t,a,b,e\n0,false,false,\n1,,,1\n")
    assert main(["why", str(spec), str(trace), "R1"]) == 2
    assert "`a` was never true while `e` was (first at 1 s)" in capsys.readouterr().err


def test_until_is_the_end_that_is_judged(tmp_path, capsys):
    """What comes behind it is not looked at."""
    spec, trace = tmp_path / "s.rv", tmp_path / "t.csv"
    spec.write_text('spec s\nevent e, f\nrequirement R1 "x"\n  upon e\n  then within 5 s f\n')
    trace.write_text("t,e,f\n0,1,\n3,,1\n")
    assert main(["why", str(spec), str(trace), "R1", "--until", "2"]) == 0
    assert "a recording more than 3 s longer would have decided it" in " ".join(
        capsys.readouterr().out.split()
    )


def test_it_says_how_late_what_was_awaited_came(door, capsys):
    """The whole recording tells what came after the deadline."""
    (door / "slow.csv").write_text("t,closed,knock\n0,1,\n1,,1\n3.02,0,\n5,,\n")
    assert main(["why", "door.rv", "slow.csv", "D1"]) == 0
    told = "it came at 3.02 s, 20 ms after the deadline"
    assert told in " ".join(capsys.readouterr().out.split())


def test_what_a_log_lost_is_known_to_nobody(door, capsys):
    """The verdict is that of `rvmon run`, and the rows are not known where the log was dropped."""
    write_ulog(door / "a.ulg", [(10**6 + 10_000 * k, 1.0, 2) for k in range(100)], [(49, 250)])
    (door / "u.toml").write_text('[bind.speed]\ntopic = "/drive"\nvalue = "speed"\nunit = "m/s"\n')
    (door / "u.rv").write_text(
        "signal speed : real [m/s]\nrequirement R\n  upon start then for 900 ms speed < 3 m/s\n"
    )
    asked = ["u.rv", "a.ulg", "--binding", "u.toml", "--format", "json"]
    assert main(["run", *asked]) == 0
    assert json.loads(capsys.readouterr().out)["requirements"]["R"]["verdict"] == "I"
    assert main(["why", *asked[:2], "R#1", *asked[2:]]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["attempt"]["verdict"] == "I"
    row = next(one for one in told["part_truths"] if one["text"] == "speed < 3 m/s")
    second = 10**9
    print(row)
    assert row["true"] == [[second, row["true"][0][1]], [row["true"][1][0], 2 * second - 10**7]]
    assert row["false"] == []
    lost = range(row["true"][0][1] + 1, row["true"][1][0])
    assert len(lost) >= second // 4
    assert second + 5 * second // 10 in lost


def test_an_attempt_at_the_end_has_no_row_for_its_trigger(tmp_path, capsys):
    """`end` is no part that would be true at some instants; `true` as a trigger says nothing."""
    (tmp_path / "a.csv").write_text("t,p\n0,1\n1,0\n")
    for trigger in ("upon end", "whenever true"):
        text = f"spec a\nsignal p : bool\nrequirement R\n{trigger} then immediately p\n"
        (tmp_path / "a.rv").write_text(text)
        command = ["why", str(tmp_path / "a.rv"), str(tmp_path / "a.csv"), "R", "--format", "json"]
        assert main(command) == 0
        rows = json.loads(capsys.readouterr().out)["part_truths"]
        assert [row["text"] for row in rows] == ["immediately p", "p"][-len(rows) :], trigger
