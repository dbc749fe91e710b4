"""`rvmon verify`: answers as text and JSON, and exit codes."""

import json
from pathlib import Path

import pytest

MODELS = Path(__file__).parents[3] / "examples" / "models"


def queries(says, code, *words):
    return json.loads(says(code, "verify", *words, "--format", "json").out)["queries"]


def test_queries_hold_or_are_not_decided(says):
    model = MODELS / "fischer.ta"
    assert says(0, "verify", model, "--const", "N=2").out.count("holds: A[]") == 2
    assert queries(says, 1, model, "--max-states", "10")[0]["holds"] is None


def test_json_has_query_answer_trace_and_effort(says):
    exclusion, alive = queries(says, 1, MODELS / "fischer_broken.ta", "--const", "N=2")
    assert exclusion["holds"] is False
    assert exclusion["query"].startswith("A[] forall")
    assert {"delay", "edge", "state"} <= exclusion["trace"][0].keys()
    assert exclusion["trace"][-1]["state"]["locations"] == {"P(1)": "critical", "P(2)": "critical"}
    assert exclusion["states"] > 0
    assert exclusion["seconds"] >= 0
    assert (alive["holds"], alive["trace"]) == (True, None)


LAMP = """
unit 1 s
clock x
automaton Lamp {
  location off
  location on invariant x <= 8
  start off
  edge off -> on do x = 0 as pressed
  edge on -> off when x >= 5 do x = 0 as dark weight 0.5
}
"""


@pytest.fixture
def lamp(put):
    """A folder with the model `lamp.ta` and the specification `lamp.rv`."""
    put("lamp.ta", LAMP)
    put(
        "lamp.rv",
        "spec lamp\ntime held\nsignal lit : bool\nevent pressed, dark\n"
        "requirement OK\n  upon pressed then within 8 s dark\n"
        "requirement BAD\n  upon pressed then for 6 s lit\n",
    )


@pytest.mark.slow
@pytest.mark.usefixtures("lamp")
def test_requirements_are_decided_on_all_runs_and_example_runs_drawn(says):
    words = ["verify", "lamp.ta", "--spec", "lamp.rv", "--bind", "lit=Lamp.on"]
    out = says(1, *words).out
    assert "OK: holds on all runs" in out
    assert "BAD: fails on some run" in out
    assert out.count("fails:") == 1
    lines = [line.strip() for line in out.splitlines()]
    drawn = [line.split()[-1] for line in lines if line.startswith(("OK ", "BAD "))]
    assert drawn == ["P", "P", "F"]
    assert "lit      ▇▇▇▇▇▇▇▇▇▁▁▁▁▁▁▁▁▁" in lines
    ok, bad = json.loads(says(1, *words, "--format", "json").out)["requirements"]
    assert (ok["holds"], ok["failing"]) == (True, None)
    assert bad["failing"][-1]["state"]["locations"] == {"Lamp": "off"}


@pytest.mark.usefixtures("lamp")
def test_suites_cover_edges_and_pairs_of_edges(says):
    verify = ["verify", "lamp.ta"]
    assert "1 run covers 2 of 2 edges" in says(0, *verify, "--suite", "edges").out
    suite = json.loads(says(0, *verify, "--suite", "edge-pairs", "--format", "json").out)
    assert suite["missing"] == []
    assert suite["runs"][0]["trace"]


@pytest.mark.usefixtures("lamp")
def test_names_missing_in_the_specification_or_the_model_are_reported(says):
    verify = ["verify", "lamp.ta", "--spec", "lamp.rv"]
    told = says(2, *verify, "--bind", "light=Lamp.on").err
    assert "no signal of that name is declared: there are lit" in told
    told = says(1, *verify).out
    assert "BAD: not expressible: the network has no signal `lit`" in told
