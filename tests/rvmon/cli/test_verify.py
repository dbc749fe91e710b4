"""`rvmon verify` prints answers for people and programs, and exits accordingly."""

import json
from pathlib import Path

import pytest

from rvmon.cli import main

MODELS = Path(__file__).parents[3] / "examples" / "models"


def test_all_queries_hold(capsys):
    """A model whose queries all hold exits with 0."""
    assert main(["verify", str(MODELS / "fischer.ta"), "--const", "N=2"]) == 0
    assert capsys.readouterr().out.count("holds: A[]") == 2


def test_json_has_the_promised_shape(capsys):
    """Query, answer, trace of delays, edges and states, cost: as other programs rely on."""
    model = str(MODELS / "fischer_broken.ta")
    assert main(["verify", model, "--const", "N=2", "--format", "json"]) == 1
    exclusion, alive = json.loads(capsys.readouterr().out)["queries"]
    assert exclusion["holds"] is False
    assert exclusion["query"].startswith("A[] forall")
    assert {"delay", "edge", "state"} <= exclusion["trace"][0].keys()
    assert exclusion["trace"][-1]["state"]["locations"] == {
        "P(1)": "critical",
        "P(2)": "critical",
    }
    assert exclusion["states"] > 0
    assert exclusion["seconds"] >= 0
    assert (alive["holds"], alive["trace"]) == (True, None)


def test_a_budget_gives_null(capsys):
    """A query that the budget did not decide is null, and the exit code says so."""
    model = str(MODELS / "fischer.ta")
    assert main(["verify", model, "--max-states", "10", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["queries"][0]["holds"] is None


def test_queries_by_id_and_by_text(capsys):
    """A query of the model is meant by its id, any other is read."""
    model = str(MODELS / "bridge.ta")
    texts = ["--query", "quicker", "--query", "E<> Torch.two"]
    assert main(["verify", model, *texts, "--format", "json"]) == 1
    first, second = json.loads(capsys.readouterr().out)["queries"]
    assert (first["id"], first["holds"]) == ("quicker", False)
    assert second["holds"] is True


def test_the_run_is_shown_in_seconds(tmp_path, capsys):
    """A model with a unit of time shows its run in seconds."""
    model = tmp_path / "slow.ta"
    model.write_text("""unit 50 ms clock x
    automaton A { location a location b start a edge a -> b when x >= 10 }
    query: E<> A.b""")
    assert main(["verify", str(model)]) == 0
    assert "0.5 s  A: a → b   (after [0.5 s, ∞))" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["missing.ta"], "No such file"),
        ([str(MODELS / "bridge.ta"), "--query", "E<> Nobody.safe"], "no automaton `Nobody`"),
        ([str(MODELS / "bridge.ta"), "--query", "cross"], "no query `cross`\nhelp: it has "),
        ([str(MODELS / "bridge.ta"), "--query", "Torch.one"], "a query speaks of runs"),
        ([str(MODELS / "fischer.ta"), "--const", "N"], "expected NAME=NUMBER"),
        ([str(MODELS / "fischer.ta"), "--const", "M=2"], "no constant `M`"),
        ([str(MODELS / "fischer.ta"), "--const", "N=" + "9" * 5000], "expected NAME=NUMBER"),
        ([str(MODELS / "bridge.ta"), "--max-states", "0"], "at least 1"),
        ([str(MODELS / "bridge.ta"), "--max-states", "-1"], "at least 1"),
        ([str(MODELS / "bridge.ta"), "--max-memory", "0"], "at least 1"),
        ([str(MODELS / "bridge.ta"), "--max-seconds", "nan"], "a time in seconds"),
        ([str(MODELS / "bridge.ta"), "--max-seconds", "-1"], "at least 0"),
        ([str(MODELS / "bridge.ta"), "--spec", "a.rv", "--suite", "edges"], "not allowed with"),
        ([str(MODELS / "bridge.ta"), "--suite", "edges", "--query", "over"], "does nothing"),
        ([str(MODELS / "bridge.ta"), "--bind", "a=b"], "does nothing without --spec"),
    ],
)
def test_wrong_input_exits_with_2(arguments, message, capsys):
    """What cannot be checked is said on standard error, without a traceback."""
    assert main(["verify", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


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
    """A model and a specification of it."""
    model, spec = tmp_path / "lamp.ta", tmp_path / "lamp.rv"
    model.write_text(LAMP)
    spec.write_text(
        "spec lamp\ntime held\nsignal lit : bool\nevent pressed, dark\n"
        "requirement OK\n  upon pressed then within 8 s dark\n"
        "requirement BAD\n  upon pressed then for 6 s lit\n"
    )
    return str(model), str(spec)


def test_requirements_on_all_runs(lamp, capsys):
    """Each requirement is decided, with runs that trigger, pass and fail it."""
    model, spec = lamp
    assert main(["verify", model, "--spec", spec, "--bind", "lit=Lamp.on"]) == 1
    out = capsys.readouterr().out
    assert "OK: holds on all runs" in out
    assert "BAD: fails on some run" in out
    assert out.count("fails:") == 1
    arguments = ["--spec", spec, "--bind", "lit=Lamp.on", "--format", "json"]
    assert main(["verify", model, *arguments]) == 1
    ok, bad = json.loads(capsys.readouterr().out)["requirements"]
    assert (ok["holds"], ok["failing"]) == (True, None)
    assert bad["failing"][-1]["state"]["locations"] == {"Lamp": "off"}


def test_suites(lamp, capsys):
    """Few runs that go through all edges are shown, as text and as data."""
    model, _ = lamp
    assert main(["verify", model, "--suite", "edges"]) == 0
    assert "1 runs go through 2 of 2 edges" in capsys.readouterr().out
    assert main(["verify", model, "--suite", "edge-pairs", "--format", "json"]) == 0
    suite = json.loads(capsys.readouterr().out)
    assert suite["missing"] == []
    assert suite["runs"][0]["trace"]


def test_a_binding_needs_a_signal(lamp, capsys):
    """A name that the specification does not declare is told with those that it does."""
    assert main(["verify", lamp[0], "--spec", lamp[1], "--bind", "light=Lamp.on"]) == 2
    assert "no signal of that name is declared: lit" in capsys.readouterr().err


def test_runs_are_drawn_as_timelines(lamp, capsys):
    """What a requirement reads along each run stands below it, judged as a recording would be."""
    model, spec = lamp
    assert main(["verify", model, "--spec", spec, "--bind", "lit=Lamp.on"]) == 1
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    drawn = [line.split() for line in lines if line.startswith(("OK ", "BAD "))]
    assert [line[-1] for line in drawn] == ["P", "P", "F"]
    assert "lit      ▇▇▇▇▇▇▇▇▇▁▁▁▁▁▁▁▁▁" in lines


def test_a_requirement_beyond_the_model_is_said_plainly(lamp, capsys):
    """The line gives the reason and no second word for it, and the exit code is 1."""
    model, spec = lamp
    assert main(["verify", model, "--spec", spec]) == 1
    assert "BAD: not expressible: the network has no signal `lit`" in capsys.readouterr().out


def test_several_queries_in_one_word(capsys):
    """Each has its own option."""
    assert main(["verify", "examples/models/fischer.ta", "--query", "exclusion,alive"]) == 2
    assert "write --query exclusion --query alive" in capsys.readouterr().err
