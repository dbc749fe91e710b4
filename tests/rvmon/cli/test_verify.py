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
        ([str(MODELS / "bridge.ta"), "--query", "Torch.one"], "a query speaks of runs"),
        ([str(MODELS / "fischer.ta"), "--const", "N"], "expected NAME=NUMBER"),
        ([str(MODELS / "fischer.ta"), "--const", "M=2"], "no constant `M`"),
    ],
)
def test_wrong_input_exits_with_2(arguments, message, capsys):
    """What cannot be checked is said on standard error, without a traceback."""
    assert main(["verify", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error
