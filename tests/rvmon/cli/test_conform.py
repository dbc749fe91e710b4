"""`rvmon conform` says whether recordings are runs of a model, and exits accordingly."""

import json

import pytest

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
def conform(put, says):
    """Compare recordings with the lamp."""
    put("lamp.ta", MODEL)
    put("good.csv", "t,pressed,dark\n10,0,0\n12,1,\n16,,1\n")
    put("bad.csv", "t,pressed,dark\n10,0,0\n12,1,\n18,,1\n")
    put("text.jsonl", '{"t": 0, "text": "hello"}\n')
    return lambda code, words: says(code, "conform", "lamp.ta", *words.split())


def test_a_recording_conforms_or_its_first_deviation_is_shown(conform):
    assert "conforms; 2 actions explained" in conform(0, "good.csv").out
    out = conform(1, "good.csv bad.csv").out
    assert "diverges at 8 s, 1 action explained before: `dark`" in out
    assert "`dark` from 5 to 7 s" in out
    answer = json.loads(conform(1, "bad.csv --format json").out)["bad.csv"]
    assert answer["conforms"] is False
    assert answer["divergence"]["label"] == "dark"
    assert answer["divergence"]["allowed"] == [
        {"label": "dark", "earliest": 5_000_000_000, "latest": 7_000_000_000}
    ]


def test_a_budget_may_leave_the_answer_open(conform):
    out = conform(1, "good.csv --observe dark --max-states 1").out
    assert "good.csv: not decided: " in out
    conform(0, "good.csv --observe dark")


def test_a_tolerance_accepts_small_deviations_and_until_sets_the_end(conform):
    conform(0, "bad.csv --tolerance 0.5")
    conform(0, "good.csv --until 60")
    conform(0, "good.csv --until 60 --observe pressed")
    shown = conform(0, "bad.csv --until 6")
    assert "conforms; 1 action explained" in shown.out
    assert "1 later action is ignored" in shown.err


def test_a_recording_without_the_observed_action_may_be_a_quiet_run(conform):
    assert "conforms; 0 actions explained" in conform(0, "text.jsonl --observe pressed").out
