"""The command `mutate` as a person uses it."""

import json
import re
from dataclasses import replace

import pytest
from tests.rvmon.cdv.conftest import needs_fork
from tests.tools.each import each
from tests.tools.looked_at import faults

from rvmon.cdv.mutation.python_mutants import code_mutants
from rvmon.cdv.test import save
from rvmon.cli.campaign import main

pytestmark = [pytest.mark.process, needs_fork]


def equivalent(campaign, folder, part):
    """The campaign; mutants with this text in their name are declared equivalent."""
    path = folder / "equivalent.toml"
    lines = [
        f"{json.dumps(one.identity)} = {json.dumps(one.brief)}"
        for one in code_mutants(campaign.code)
        if part in one.identity
    ]
    assert lines
    path.write_text("\n".join(['[all]\nbecause = "nobody sees it"\n[all.mutants]', *lines]))
    return replace(campaign, code=replace(campaign.code, equivalent=path))


def test_a_suite_is_scored(campaign, tmp_path, capsys):
    out = tmp_path / "out"
    command = ["mutate", "--only", "Lift.note", "--jobs", "1", "--held-out", "--out", str(out)]
    assert main(campaign, command) == 0
    told = capsys.readouterr().out
    suite = json.loads((out / "mutation.json").read_text())["suites"]["rides"]
    score = suite["scores"]["all"]
    assert score["mutants"] == len(suite["mutants"]) == 1
    assert re.search(r"all +1 +0 +0 ", told)
    assert "3 tests run it, and nothing that is recorded differs" in told
    assert (out / "mutation.txt").read_text() in told
    assert "nothing that is recorded differs" in (out / "mutation.html").read_text()


@pytest.mark.parametrize("others", [[], ["mine.txt"]])
def test_who_interrupts_leaves_no_empty_folder(others, campaign, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("rvmon.cli.campaign_mutate.record_suite", interrupted)
    for name in others:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / name).touch()
    command = ["mutate", "--only", "Lift.note", "--jobs", "1", "--out", str(tmp_path / "out")]
    assert main(campaign, command) == 130
    assert (tmp_path / "out").exists() == bool(others)


def test_pages_are_fit_for_everybody(campaign, chromium, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = ["mutate", "--only", "Lift.note", "--jobs", "1", "--held-out", "--out", "out"]
    assert main(campaign, command) == 0
    assert main(campaign, ["run", "--tests", "2", "--jobs", "1", "--out", "out"]) == 0
    pages = {path.name: path.read_text() for path in tmp_path.glob("out/**/*[a-z].html")}
    assert {"mutation.html", "report.html", "coverage.html"} <= pages.keys()
    assert faults(chromium, tmp_path, pages) == []


def test_a_folder_of_tests_is_a_suite(campaign, tmp_path, capsys):
    folder = tmp_path / "closed"
    folder.mkdir()
    for test in campaign.strategies["rides"](2, 1):
        save(test, folder)
    command = ["mutate", "--tests", str(folder), "--of", "spec", "--format", "json"]
    assert main(campaign, command) == 0
    suites = json.loads(capsys.readouterr().out)["suites"]
    assert suites["closed"]["tests"] == 2
    assert suites["closed"]["spec_scores"]["all"]["killed"] > 0


def test_mutants_are_listed_without_those_held_out(campaign, capsys):
    assert main(campaign, ["mutate", "--list"]) == 0
    told = capsys.readouterr().out
    assert "Lift.ride:dropped-statement:1" in told
    assert "L1:bound:1" in told
    assert re.search(r"\d+ mutants, \d+ of them held out and not listed", told)
    assert not re.search("^held out", told, re.MULTILINE)


def test_a_mutant_declared_equivalent_does_not_count_and_must_not_be_killed(
    campaign, tmp_path, capsys
):
    """With --strict, all others have to be killed."""
    known = equivalent(campaign, tmp_path, "Lift.note")
    command = ["mutate", "--of", "code", "--only", "note", "--jobs", "1", "--strict"]
    assert main(campaign, command) == 1
    assert main(known, command) == 0
    name = "Lift.ride:dropped-statement:5"
    known = equivalent(campaign, tmp_path, name)
    assert main(known, ["mutate", "--of", "code", "--only", name, "--jobs", "1"]) == 1
    assert f"lift:{name} is declared equivalent, and requirement (L1)" in capsys.readouterr().err


@each(
    ("arguments", "message"),
    [
        (["--tests", "0"], "at least 1"),
        (["--tests", "nowhere"], "a number, or a folder of tests, not nowhere"),
        (["--tests", ".", "--strategy", "rides"], "a suite by itself: omit --strategy"),
        (["--only", "nothing"], "no mutant has `nothing` in its name"),
        (["--strategy", "walks"], "no strategy `walks`"),
        (["--robot", "base"], "no robot `base`"),
    ],
)
def test_what_is_wrong_is_told(campaign, capsys, arguments, message):
    assert main(campaign, ["mutate", *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_campaign_without_code_or_requirements_is_refused(campaign, capsys):
    assert main(replace(campaign, code=None), ["mutate"]) == 2
    assert "names no code" in capsys.readouterr().err
    robots = {"lift": replace(campaign.robots["lift"], spec=None)}
    assert main(replace(campaign, robots=robots), ["mutate"]) == 2
    assert "has no requirements" in capsys.readouterr().err
