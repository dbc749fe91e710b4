"""The command `handover close` as a person uses it."""

import contextlib
import io
import json

import pytest

from handover.campaign.closing import UNREACHABLE, query_of
from handover.cli import main
from handover.model import handover_network
from rvmon.cli import main as rvmon
from rvmon.models.language.elaborate import chosen_queries
from rvmon.texts import share_text

pytestmark = pytest.mark.campaign


@pytest.fixture(scope="module")
def closed(shared):
    """A folder with a suite of a few tests, the exit code and the output."""

    def make(folder):
        told = io.StringIO()
        with contextlib.redirect_stdout(told):
            code = main(["close", "--tests", "12", "--jobs", "1", "--out", str(folder / "out")])
        (folder / "told.json").write_text(json.dumps([code, told.getvalue()]))

    folder = shared("closed", make)
    return folder / "out", *json.loads((folder / "told.json").read_text())


def test_the_model_leads_to_all_outcomes_at_once(closed):
    folder, code, told = closed
    document = json.loads((folder / "closing.json").read_text())
    met = {tuple(goal) for test in document["tests"] for goal in test["added"]}
    assert {("R1", "passed"), ("situation", "no × no × no × kept"), ("ending", "gave_up")} <= met
    assert code == 1
    assert "12 tests" in told
    assert document["ended"] == "after 12 tests"
    assert len(document["open"]) == document["goals"] - document["met"]


def test_all_say_the_same_share(closed, capsys):
    folder, _, told = closed
    share = json.loads((folder / "closing.json").read_text())["share"]
    words = f"{share_text(share)} covered"
    assert f"{words}: " in told
    assert f"<h1>{words}" in (folder / "coverage.html").read_text()
    assert f">{words}</a>" in (folder / "report.html").read_text()
    database = str(folder / "coverage.db")
    below, above = (f"{100 * share + by}%" for by in (-0.01, 0.01))
    assert rvmon(["cover", database, "--require", below]) == 0
    assert rvmon(["cover", database, "--require", above]) == 1
    assert "excluded because they cannot be hit" in (folder / "coverage.html").read_text().lower()
    capsys.readouterr()


def test_unreachable_items_are_proved_by_a_query(closed):
    """The deadlines of R1 and R3 are never nearly missed, by the model's bounds."""
    folder, _, told = closed
    proved = json.loads((folder / "closing.json").read_text())["proved"]
    assert {tuple(one["goal"]) for one in proved} == {
        (name, item)
        for name in ("R1", "R3")
        for item in ("just before the deadline", "at the deadline")
    }
    texts = {(one.group, one.item): one.reason for one in UNREACHABLE if one.by_model}
    assert texts == {tuple(one["goal"]): f"the model proves it: {one['text']}" for one in proved}
    assert "-->[<=539] (robot.judged or timedOut)" in " ".join(told.split())


def test_no_unreachable_item_was_ever_hit(closed):
    """Neither here nor in any stored campaign; each entry names an item."""
    folder, _, _ = closed
    document = json.loads((folder / "closing.json").read_text())
    assert document["wrong"] == []
    argued = {one.reason for one in UNREACHABLE if not one.by_model}
    assert {one["text"] for one in document["argued"]} == argued


def test_the_suite_is_played_again_from_its_folder(closed, capsys):
    folder, _, _ = closed
    suite = json.loads((folder / "closing.json").read_text())["suite"]
    assert {path.stem for path in (folder / "tests").iterdir()} == set(suite)
    capsys.readouterr()
    assert main(["run", "--suite", str(folder / "tests"), "--jobs", "1", "--format", "json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["robots"] == json.loads((folder / "table.json").read_text())["robots"]
    page = (folder / "coverage.html").read_text()
    assert "edges of the model" in page
    assert "only the legacy robot does so" in page


def test_nonsense_is_refused(tmp_path, capsys):
    assert main(["run", "--suite", str(tmp_path)]) == 2
    assert "no test (.json) in this folder" in capsys.readouterr().err
    assert main(["close", "--strategy", "guessing"]) == 2
    assert "no strategy `guessing`: there are pseudorandom" in capsys.readouterr().err


def test_all_questions_to_the_model_are_among_its_queries():
    """For every item of situations and requirements."""
    items = [
        *(("situation", f"{g} × {p} × {at} × {o}") for g in ("yes", "no") for p in ("yes", "no")
          for at in ("yes", "no") for o in ("given", "kept")),
        *(("ending", ending) for ending in ("given", "kept", "gave_up")),
        *((name, "at the deadline") for name in ("R1", "R3")),
        ("edges of the model", "robot: sense → done"),
    ]  # fmt: skip
    assert chosen_queries(handover_network(), [query_of(*item) for item in items])
    assert query_of("R2", "triggered") == ""
