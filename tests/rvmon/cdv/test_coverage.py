"""Coverage of a campaign: hits of all models, a database and a page for each robot."""

import random
import sqlite3
from dataclasses import replace

import pytest

from rvmon.cdv import Campaign, ExpectedFailure, Robot, Run, Test
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.coverage import coverage_model, write_coverage
from rvmon.cdv.play import execute
from rvmon.coverage import count_of, merged
from rvmon.coverage.database import read
from rvmon.errors import RvmonError

pytestmark = pytest.mark.slow

SPEC = """signal speed : real
requirement L1
  always speed <= 5
coverpoint pace = speed {slow: [0, 1), fast: [1, inf)}
"""
FURTHER = """signal speed : real
signal far : bool
coverpoint place = far {yes: true, no: false}
cross both = place
  illegal place == yes
cover stands = speed == 0
"""


class Lift:
    """Runs at speeds drawn from its seed."""

    def play(self, test, observer):
        """Play ten seconds."""
        rng = random.Random(test.seed)
        states = []
        for t_ns in range(0, 10**10, 10**9):
            speed = rng.choice([0.0, 2.0])
            observer(t_ns, {"speed": speed, "far": test.name == "lift-2", "unread": 1})
            if not states or states[-1][1] != ("moves" if speed else "stands"):
                states.append((t_ns, "moves" if speed else "stands"))
        return Run(end_ns=10**10, states=states)


def lifts(count, _seed):
    """One test for each seed."""
    return [Test(name=f"lift-{n}", strategy="any", seed=n) for n in range(count)]


@pytest.fixture
def campaign(tmp_path):
    """A campaign against two lifts, one of them with fewer goals."""
    (tmp_path / "lift.rv").write_text(SPEC)
    (tmp_path / "further.rv").write_text(FURTHER)
    specs = tmp_path / "lift.rv", (tmp_path / "further.rv",)
    return Campaign(
        name="lifts",
        test=Test,
        strategies={"any": lifts},
        robots={"new": Robot(Lift, specs[0], specs[1], title="New lift"), "old": Robot(Lift, None)},
        states=("stands", "moves"),
        transitions=(("stands", "moves"), ("moves", "stands")),
    )


def test_all_models_are_gathered(campaign):
    results = execute(plan(campaign, tests=3), jobs=1)
    hits = merged([one.outcome.hits for one in results.played if one.job.robot == "new"])
    assert {"pace", "place", "both", "stands", "L1", "states"} <= hits.keys()
    assert count_of(hits, "pairs of transitions", "stands → moves → stands") > 0
    assert count_of(hits, "both", "yes") == 1
    old = merged([one.outcome.hits for one in results.played if one.job.robot == "old"])
    assert old.keys() == {"states", "transitions", "pairs of transitions"}


def test_states_imply_transitions(campaign):
    """From each state to each other one; if some are listed, only these and their pairs."""
    three = replace(campaign, states=("stands", "moves", "waits"), transitions=None)
    groups = coverage_model(three, "new").groups
    assert len(groups["transitions"].items) == 6
    assert "moves → moves" not in groups["transitions"].items
    assert not groups["pairs of transitions"].items
    listed = coverage_model(campaign, "new").groups
    assert list(listed["transitions"].items) == ["stands → moves", "moves → stands"]
    assert not coverage_model(replace(three, transitions=()), "new").groups["transitions"].items


def test_a_database_and_a_page_each(campaign, tmp_path):
    results = execute(plan(campaign, tests=3), jobs=1)
    pages = {("new", "lift-1"): "runs/new-lift-1.html"}
    for _ in range(2):
        figures = write_coverage(tmp_path / "out", results, pages)
    assert figures["new"].page == "new/coverage.html"
    assert figures["new"].illegal == ("both: yes",)
    assert 'href="../runs/new-lift-1.html"' in (tmp_path / "out/new/coverage.html").read_text()
    found = read([tmp_path / "out/new/coverage.db"])
    assert [entry.record.name for entry in found.entries] == ["lift-0", "lift-1", "lift-2"]
    assert {entry.record.strategy for entry in found.entries} == {"any"}
    assert found.model.groups.keys() == coverage_model(campaign, "new").groups.keys()
    with sqlite3.connect(tmp_path / "out/old/coverage.db") as database:
        assert database.execute("pragma integrity_check").fetchone() == ("ok",)


def test_what_is_expected_to_fail_goes_with_the_test(campaign, tmp_path):
    why = ExpectedFailure("L1", "it is no real lift", test="lift-1")
    expecting = replace(campaign, expected_failures=[why], robots={"new": campaign.robots["new"]})
    write_coverage(tmp_path / "out", execute(plan(expecting, tests=2), jobs=1), {})
    entries = read([tmp_path / "out/coverage.db"]).entries
    assert [entry.record.expected for entry in entries] == [{}, {"L1": "it is no real lift"}]


def test_one_name_for_two_things(campaign, tmp_path):
    (tmp_path / "further.rv").write_text(FURTHER.replace("place", "pace"))
    with pytest.raises(RvmonError, match="two groups have the same name, `pace`"):
        coverage_model(campaign, "new")
