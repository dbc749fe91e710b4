"""What tests hit of coverage models: an error if it must not be, else kept in a database."""

import pytest

from rvmon import cdv
from rvmon.cli.campaign import main
from rvmon.coverage.database import read

pytestmark = pytest.mark.process

MODEL = """
coverpoint height = level {low: [0, 2), middle: [2, 5), illegal high: [5, inf)}
"""
SITUATIONS = """
spec situations
event over
coverpoint ending {well: over, badly: start and not over}
"""
LOW, MIDDLE, HIGH = (("low", {}), ("middle", {"level": 3.0}), ("high", {"level": 6.0}))


@pytest.fixture
def watched(spec, monkeypatch):
    """The toy's requirements have a coverage model."""
    monkeypatch.chdir(spec.parent)
    spec.write_text(spec.read_text() + MODEL)


def hits(path):
    """What is in a database: counts by test, group and item, and the groups of its model."""
    coverage = read([path])
    found = {
        entry.record.name: {
            coverage.items[item]: int(count)
            for item, count in zip(entry.row.items, entry.row.counts, strict=True)
        }
        for entry in coverage.entries
    }
    return found, coverage


def test_what_must_not_be_hit_is_an_error_of_the_test(watched, campaign, capsys):
    """On the robot as it is, whether or not coverage is kept."""
    known = ("known", {"level": 6.0, "expected": {"T1": "F"}})
    assert main(campaign(LOW, known), ["run"]) == 1
    told = capsys.readouterr().err
    assert "not as expected: known (toy): illegal: `high` of `height` was hit at 1 s" in told
    assert main(campaign(LOW, MIDDLE), ["run"]) == 0


def test_all_that_tests_hit_is_kept(watched, campaign, code, tmp_path):
    """Coverpoints, requirements, states and code, by test, with what became of it."""
    code = cdv.Code(cdv.blocks_of(code))
    chosen = campaign(LOW, MIDDLE, states=("down", "up", "sideways"), code=code)
    assert main(chosen, ["run", "--seed", "3", "--coverage", "toys.cov"]) == 0
    found, coverage = hits(tmp_path / "toys.cov")
    assert found["low"]["height", "low"] == 1
    assert found["middle"]["height", "middle"] == 1
    assert found["middle"]["T2", "passed"] == 1
    assert found["middle"]["states entered", "down"] == 2
    groups = coverage.model.groups
    assert list(groups["states entered"].items) == ["down", "up", "sideways"]
    assert groups["transitions taken"].items["down → up"].kind == "ignore"
    assert "statements of Toy.climb" in groups
    record = coverage.entries[0].record
    assert (record.campaign, record.strategy, record.system, record.seed) == (
        "toys, seed 3",
        "climbs",
        "toy",
        3,
    )
    assert record.verdicts == {"T1": "P", "T2": "NT", "T3": "P"}


def test_campaigns_add_to_a_database(watched, campaign, tmp_path):
    """Also tests that hung, which hit nothing that is known; planted faults are left out."""
    words = ["run", "--coverage", "toys.cov", "--timeout", "1"]
    main(campaign(LOW), words)
    main(campaign(MIDDLE, ("hangs", {"does": "hang"})), words)
    found, coverage = hits(tmp_path / "toys.cov")
    assert set(found) == {"low", "middle", "hangs"}
    assert found["hangs"] == {}
    (hung,) = (one.record for one in coverage.entries if one.record.name == "hangs")
    assert (hung.ending, hung.error) == ("hung", "it took more than 1 s")


def test_situations_can_stand_in_a_file_of_their_own(spec, campaign, tmp_path, monkeypatch):
    """They are watched where coverage is kept."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "situations.rv").write_text(SITUATIONS)
    robots = campaign().robots
    robot = cdv.Robot(robots["toy"].system, spec, situations=tmp_path / "situations.rv")
    assert main(campaign(LOW, robots={"toy": robot}), ["run", "--coverage", "toys.cov"]) == 0
    found, _ = hits(tmp_path / "toys.cov")
    assert found["low"]["ending", "well"] == 1


def test_models_that_contradict_each_other_are_told_first(watched, campaign, tmp_path, capsys):
    """Before anything is played; so is what is no database."""
    (tmp_path / "twice.rv").write_text("spec twice\nsignal level : real\n" + MODEL)
    toy = campaign().robots["toy"]
    robots = {"toy": cdv.Robot(toy.system, toy.spec, situations=tmp_path / "twice.rv")}
    words = ["run", "--coverage", "toys.cov"]
    assert main(campaign(("x", {"does": "hang"}), robots=robots), words) == 2
    assert "robot `toy`: its coverage models have two groups of one name: `height`" in (
        capsys.readouterr().err
    )
    (tmp_path / "toys.cov").write_text("mine")
    assert main(campaign(("x", {"does": "hang"})), words) == 2
    assert (tmp_path / "toys.cov").read_text() == "mine"
