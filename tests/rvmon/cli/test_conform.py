"""`rvmon conform` says whether recordings are runs of a model, and exits accordingly."""

import json

import pytest

from rvmon.cli import main

MODEL = """
unit 100 ms
clock x
automaton Lamp {
  location off
  location on invariant x <= 50
  start off
  edge off -> on do x = 0 as pressed
  edge on -> off when x >= 30 as dark
}
"""


@pytest.fixture
def folder(tmp_path):
    """A model with a recording that conforms and one that does not."""
    (tmp_path / "lamp.ta").write_text(MODEL)
    (tmp_path / "good.csv").write_text("t,pressed,dark\n10,0,0\n12,1,\n16,,1\n")
    (tmp_path / "text.csv").write_text("t,text\n0,hello\n1,there\n")
    (tmp_path / "text.jsonl").write_text('{"t": 0, "text": "hello"}\n')
    (tmp_path / "bad.csv").write_text("t,pressed,dark\n10,0,0\n12,1,\n18,,1\n")
    return tmp_path


def test_a_run_that_conforms(folder, capsys):
    """A recording within the model's bounds exits with 0."""
    assert main(["conform", str(folder / "lamp.ta"), str(folder / "good.csv")]) == 0
    assert "conforms; 2 actions explained" in capsys.readouterr().out


def test_a_run_that_does_not(folder, capsys):
    """A recording that leaves the model exits with 1 and says where, and what was allowed."""
    files = [str(folder / name) for name in ("lamp.ta", "good.csv", "bad.csv")]
    assert main(["conform", *files]) == 1
    out = capsys.readouterr().out
    assert "diverges at 8 s, 1 action explained before: `dark`" in out
    assert "`dark` from 5 to 7 s" in out


def test_a_budget_leaves_it_open(folder, capsys):
    """A search that gives up says so, and is no answer: exit code 1."""
    files = [str(folder / name) for name in ("lamp.ta", "good.csv")]
    assert main(["conform", *files, "--observe", "dark", "--max-states", "1"]) == 1
    assert "good.csv: not decided: " in capsys.readouterr().out
    assert main(["conform", *files, "--observe", "dark"]) == 0


def test_json(folder, capsys):
    """Programs get the same as data, by recording."""
    path = str(folder / "bad.csv")
    assert main(["conform", str(folder / "lamp.ta"), path, "--format", "json"]) == 1
    answer = json.loads(capsys.readouterr().out)[path]
    assert answer["conforms"] is False
    assert answer["divergence"]["label"] == "dark"
    assert answer["divergence"]["allowed"] == [
        {"label": "dark", "earliest": 5_000_000_000, "latest": 7_000_000_000}
    ]


def test_tolerance_and_end(folder):
    """A tolerance accepts what is a little off; a longer run must go on as the model demands."""
    model, bad, good = (str(folder / name) for name in ("lamp.ta", "bad.csv", "good.csv"))
    assert main(["conform", model, bad, "--tolerance", "0.5"]) == 0
    assert main(["conform", model, good, "--until", "60"]) == 0
    assert main(["conform", model, good, "--until", "60", "--observe", "pressed"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["good.csv", "--observe", "light"], "no label `light`"),
        (["good.csv", "--tolerance", "-1"], "at least 0"),
        (["missing.csv"], "missing.csv"),
        (["text.csv"], "nothing in it is an action of the model: its actions are pressed, dark"),
        (["text.jsonl"], "nothing in it is an action of the model"),
        (["text.csv", "--observe", "dark"], "no column `dark`"),
        (["good.csv", "--until", "-1"], "at least 0"),
        (["good.csv", "--until", "inf"], "a time in seconds"),
        (["good.csv", "--tolerance", "nan"], "a time in seconds"),
    ],
)
def test_wrong_input_exits_with_2(folder, arguments, message, capsys):
    """Unknown labels, senseless tolerances and missing files are said, without a traceback."""
    words = [str(folder / a) if a.endswith(("csv", "jsonl")) else a for a in arguments]
    assert main(["conform", str(folder / "lamp.ta"), *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


def test_a_broken_recording_does_not_hide_the_others(folder, capsys):
    """The others are compared, and the exit code is that of wrong input."""
    files = [str(folder / name) for name in ("lamp.ta", "text.csv", "good.csv")]
    assert main(["conform", *files]) == 2
    assert "good.csv: conforms" in capsys.readouterr().out


def test_an_empty_recording_may_be_a_quiet_run(folder, capsys):
    """Who says what would be seen may have a recording in which nothing of it is."""
    words = [str(folder / "lamp.ta"), str(folder / "text.jsonl"), "--observe", "pressed"]
    assert main(["conform", *words]) == 0
    assert "conforms; 0 actions explained" in capsys.readouterr().out


def test_until_may_cut_a_recording(folder, capsys):
    """What comes after the given end is not compared."""
    words = [str(folder / "lamp.ta"), str(folder / "bad.csv"), "--until", "6"]
    assert main(["conform", *words]) == 0
    shown = capsys.readouterr()
    assert "conforms; 1 action explained" in shown.out
    assert "1 later action is not looked at" in shown.err
