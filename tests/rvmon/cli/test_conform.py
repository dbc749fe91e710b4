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
    (tmp_path / "lamp.ta").write_text(MODEL)
    (tmp_path / "good.csv").write_text("t,pressed,dark\n10,0,0\n12,1,\n16,,1\n")
    (tmp_path / "text.csv").write_text("t,text\n0,hello\n1,there\n")
    (tmp_path / "bad.csv").write_text("t,pressed,dark\n10,0,0\n12,1,\n18,,1\n")
    return tmp_path


def test_each_recording_conforms_or_is_told_where_it_does_not(folder, says):
    model, good, bad = (str(folder / name) for name in ("lamp.ta", "good.csv", "bad.csv"))
    assert "conforms; 2 actions explained" in says(0, "conform", model, good).out
    out = says(1, "conform", model, good, bad).out
    assert "diverges at 8 s, 1 action explained before: `dark`" in out
    assert "`dark` from 5 to 7 s" in out
    answer = json.loads(says(1, "conform", model, bad, "--format", "json").out)[bad]
    assert answer["conforms"] is False
    assert answer["divergence"]["label"] == "dark"
    assert answer["divergence"]["allowed"] == [
        {"label": "dark", "earliest": 5_000_000_000, "latest": 7_000_000_000}
    ]


def test_a_budget_leaves_it_open(folder, capsys):
    files = [str(folder / name) for name in ("lamp.ta", "good.csv")]
    assert main(["conform", *files, "--observe", "dark", "--max-states", "1"]) == 1
    assert "good.csv: not decided: " in capsys.readouterr().out
    assert main(["conform", *files, "--observe", "dark"]) == 0


def test_tolerance_and_end(folder, says):
    """What is a little off is accepted; a longer run has to go on, a shorter one is cut."""
    model, bad, good = (folder / name for name in ("lamp.ta", "bad.csv", "good.csv"))
    says(0, "conform", model, bad, "--tolerance", "0.5")
    says(0, "conform", model, good, "--until", "60")
    says(0, "conform", model, good, "--until", "60", "--observe", "pressed")
    shown = says(0, "conform", model, bad, "--until", "6")
    assert "conforms; 1 action explained" in shown.out
    assert "1 later action is ignored" in shown.err


def test_an_empty_recording_may_be_a_quiet_run(folder, says):
    """Who says what would be seen may have a recording in which nothing of it is."""
    (folder / "text.jsonl").write_text('{"t": 0, "text": "hello"}\n')
    words = [str(folder / "lamp.ta"), str(folder / "text.jsonl"), "--observe", "pressed"]
    assert "conforms; 0 actions explained" in says(0, "conform", *words).out
