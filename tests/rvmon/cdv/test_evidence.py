"""Evidence of campaigns: tests are replayed from the archive alone."""

import json

import pytest

from rvmon import cdv
from rvmon.cli import campaign as cli
from rvmon.cli import main
from rvmon.evidence import pack, unpack

pytestmark = pytest.mark.process

TESTS = [("low", {"level": 1.0}), ("crash", {"does": "crash"}), ("kill", {"does": "kill"})]


class Reckless:
    """Climbs higher than the test allows."""

    def play(self, test, observer):
        observer(0, {"level": 9.0})
        return cdv.Run(1_000_000_000)


@pytest.fixture
def made(campaign, tmp_path, monkeypatch):
    """Plays a campaign of some tests and writes its evidence to `e.zip`."""
    monkeypatch.chdir(tmp_path)

    def kept(count):
        toys = campaign(*TESTS[:count])
        assert cli.main(toys, ["run", "--jobs", "1", "--evidence", "e.zip"]) == (count > 1)
        return toys

    return kept


def verify(capsys, campaign, *words):
    """The exit code and output of `evidence verify`."""
    capsys.readouterr()
    verified = ["evidence", "e.zip", *words]
    code = main(verified) if campaign is None else cli.main(campaign, verified)
    told = capsys.readouterr()
    return code, told.out + told.err


def test_the_same_campaign_gives_the_same_bytes(made, tmp_path):
    kept = made(2)
    assert cli.main(kept, ["run", "--jobs", "2", "--evidence", "f.zip"]) == 1
    assert (tmp_path / "e.zip").read_bytes() == (tmp_path / "f.zip").read_bytes()


def test_it_holds_where_its_requirements_are_gone(made, tmp_path, capsys):
    kept = made(3)
    (tmp_path / "toy.rv").write_text("spec other\n")
    code, told = verify(capsys, kept, "--sample", "all", "--jobs", "2")
    assert "evaluated again: 3 of 3" in told
    assert (code, told.splitlines()[-1]) == (0, "It holds.")
    entries = unpack("e.zip")
    assert {f"tests/{name}.json" for name, _ in TESTS} <= entries.keys()
    assert b"toy/crash,T1,,,P" in entries["verdicts.csv"]
    assert b"crashed: ZeroDivisionError" in entries["verdicts.csv"]
    assert "seconds" not in json.loads(entries["table.json"])
    assert json.loads(entries["coverage.json"])["toy"]["hits"]


def test_another_robot_is_found(made, spec, campaign, capsys):
    made(1)
    other = campaign(*TESTS, robots={"toy": cdv.Robot(Reckless, spec)})
    code, told = verify(capsys, other, "--sample", "all")
    assert code == 1
    assert "T1 in toy/low: verdict was P, is F" in told
    assert "toys has changed since" in told


def test_only_the_campaigns_own_program_replays_tests(made, campaign, capsys):
    """`rvmon` checks the rest and names the program; another campaign refuses the archive."""
    made(1)
    code, told = verify(capsys, None)
    assert (code, "evidence e.zip`" in told) == (2, True)
    code, told = verify(capsys, campaign(robots={"other": cdv.Robot(Reckless, None)}))
    assert (code, "has no robot toy" in told) == (2, True)


def test_an_invalid_test_is_refused(made, capsys):
    """Tests are data: entries that are not valid tests of the campaign are not played."""
    kept = made(1)
    entries = unpack("e.zip")
    with open("e.zip", "wb") as file:
        file.write(pack({**entries, "tests/low.json": b'{"name": "low", "strategy": 3}'}))
    code, told = verify(capsys, kept)
    assert (code, "tests/low.json: not an abstract test" in told) == (2, True)


def test_nothing_is_kept_of_what_is_not_judged(campaign, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    toys = campaign(*TESTS, robots={"toy": cdv.Robot(Reckless, None)})
    assert cli.main(toys, ["run", "--evidence", "e.zip"]) == 2
    assert "nothing to check" in capsys.readouterr().err
