"""`rvmon verify` prints answers for people and programs, and exits accordingly."""

import json
from pathlib import Path

import pytest

from rvmon.cli import main

MODELS = Path(__file__).parents[3] / "examples" / "models"


def test_queries_hold_or_are_not_decided(capsys, says):
    model = str(MODELS / "fischer.ta")
    assert says(0, "verify", model, "--const", "N=2").out.count("holds: A[]") == 2
    assert main(["verify", model, "--max-states", "10", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["queries"][0]["holds"] is None


def test_json_has_the_promised_shape(capsys):
    model = str(MODELS / "fischer_broken.ta")
    assert main(["verify", model, "--const", "N=2", "--format", "json"]) == 1
    exclusion, alive = json.loads(capsys.readouterr().out)["queries"]
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
def lamp(tmp_path):
    model, spec = tmp_path / "lamp.ta", tmp_path / "lamp.rv"
    model.write_text(LAMP)
    spec.write_text(
        "spec lamp\ntime held\nsignal lit : bool\nevent pressed, dark\n"
        "requirement OK\n  upon pressed then within 8 s dark\n"
        "requirement BAD\n  upon pressed then for 6 s lit\n"
    )
    return str(model), str(spec)


@pytest.mark.slow
def test_requirements_on_all_runs(lamp, says):
    """Each is decided, with runs that trigger, pass and fail it, drawn as a recording would be."""
    model, spec = lamp
    words = ["verify", model, "--spec", spec, "--bind", "lit=Lamp.on"]
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


def test_suites(lamp, says):
    model, _ = lamp
    assert "1 run covers 2 of 2 edges" in says(0, "verify", model, "--suite", "edges").out
    suite = json.loads(says(0, "verify", model, "--suite", "edge-pairs", "--format", "json").out)
    assert suite["missing"] == []
    assert suite["runs"][0]["trace"]


def test_names_that_the_specification_or_the_model_lacks_are_told(lamp, capsys):
    model, spec = lamp
    assert main(["verify", model, "--spec", spec, "--bind", "light=Lamp.on"]) == 2
    assert "no signal of that name is declared: there are lit" in capsys.readouterr().err
    assert main(["verify", model, "--spec", spec]) == 1
    assert "BAD: not expressible: the network has no signal `lit`" in capsys.readouterr().out
