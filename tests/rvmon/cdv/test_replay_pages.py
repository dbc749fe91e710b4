"""Files and pages of a campaign."""

import json
from dataclasses import replace

import pytest
from tests.tools.each import each

from rvmon import cdv
from rvmon.cdv.tables import Presentation
from rvmon.cdv.test import load
from rvmon.cli.campaign import main

pytestmark = pytest.mark.process


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_a_test_that_hung_has_no_page(campaign, tmp_path, capsys):
    """It cannot be replayed; the campaign's page says only that it hung."""
    tests = (("hangs", {"does": "hang"}), ("fine", {"level": 3.0}))
    # The other test may take as long as it needs on a busy machine.
    assert main(campaign(*tests), ["run", "--timeout", "5", "--jobs", "1", "--out", "out"]) == 1
    assert "not as expected: hangs (toy): hung: it took more than 5 s" in capsys.readouterr().err
    out = tmp_path / "out"
    assert [path.name for path in (out / "runs").iterdir()] == ["toy-fine.html"]
    assert "hangs hung: it took more than 5 s" in (out / "report.html").read_text()
    found = json.loads((out / "table.json").read_text())["robots"]["toy"]["strategies"]["climbs"]
    assert found["requirements"]["T3"] == {"P": 1, "F": 0, "NT": 0, "I": 1}
    assert found["hung"] == {"hangs": "it took more than 5 s"}
    assert load(out / "tests" / "hangs.json", campaign().test).does == "hang"


def test_a_system_that_is_not_repeatable_is_reported(campaign, tmp_path, spec, capsys):
    """Its pages would show other runs than its table counts."""

    class Moody:
        def play(self, test, observer):
            mood = tmp_path / "mood"
            level = 6.0 if mood.exists() else 1.0
            mood.touch()
            observer(0, {"level": level})
            return cdv.Run(1_000_000_000)

    robots = {"toy": cdv.Robot(Moody, spec)}
    assert main(campaign(("moody", {}), robots=robots), ["run", "--out", "out"]) == 0
    assert "played again, these gave other results: moody" in capsys.readouterr().err


def test_pages_of_all_runs_need_no_second_play(campaign, tmp_path, spec):
    class Counted(type(campaign().robots["toy"].system())):
        def play(self, test, observer):
            with (tmp_path / "played").open("a") as file:
                file.write(f"{test.name}\n")
            return super().play(test, observer)

    tests = (("low", {"level": 1.0}), ("high", {"level": 6.0}))
    robots = {"toy": cdv.Robot(Counted, spec)}
    words = ["run", "--jobs", "2", "--out", "out"]
    main(campaign(*tests, robots=robots), words)
    again = {path.name: path.read_text() for path in (tmp_path / "out" / "runs").iterdir()}
    assert (tmp_path / "played").read_text().split().count("high") == 2
    (tmp_path / "played").unlink()
    main(campaign(*tests, robots=robots), [*words, "--pages", "all"])
    assert {path.name: path.read_text() for path in (tmp_path / "out" / "runs").iterdir()} == again
    assert sorted((tmp_path / "played").read_text().split()) == ["high", "low"]


@each(
    ("words", "told"),
    [
        (["run", "--strategy", "luck"], "no strategy `luck`: there are climbs"),
        (["run", "--robot", "r"], "no robot `r`: there are toy"),
        (["run", "--strategy", ","], "is empty"),
        (["run", "--spec", "gone.rv"], "gone.rv"),
        (["run", "--tests", "0"], "at least 1"),
        (["run", "--tests", "many"], "at least 1"),
        (["run", "--out", __file__], "it is a file: name a folder"),
        (["run", "--timeout", "soon"], "expected seconds, or a number with its unit"),
        (["run", "--junit", "/gone/x.xml"], "cannot write /gone/x.xml: there is no folder"),
        (["replay", "gone.json"], "gone.json: No such file"),
        (["fly"], "invalid choice"),
    ],
)
def test_wrong_use_is_told(campaign, capsys, words, told):
    assert main(campaign(("fine", {})), words) == 2
    assert told in capsys.readouterr().err


def test_names_of_tests_do_not_steer_a_terminal(campaign, capsys):
    class Loud:
        def play(self, test, observer):
            raise ValueError("\x1b[31mred [bold]not[/]")

    robots = {"toy": cdv.Robot(Loud, None)}
    assert main(campaign(("loud", {}), robots=robots), ["run", "--jobs", "1"]) == 1
    told = capsys.readouterr()
    assert "\x1b" not in told.err + told.out
    assert "[bold]not[/]" in told.err


def test_the_texts_of_the_main_requirements_come_first(campaign, tmp_path, spec):
    """Those of others are folded; without main requirements all are open."""
    spec.write_text(f'{spec.read_text()}requirement Far "Up high"\n  always level < 50\n')
    made = campaign(("low", {"level": 3.0}))
    heads = []
    for foremost in (("Far",), ()):
        shown = replace(made, presentation=Presentation(foremost=foremost))
        main(shown, ["run", "--jobs", "1", "--out", f"out{len(heads)}"])
        page = (tmp_path / f"out{len(heads)}/report.html").read_text()
        heads.append(page.partition("</header>")[0].partition("<header>")[2].partition("<details>"))
    (first, _, folded), (whole, fold, _) = heads
    assert "Up high" in first
    assert "Up high" not in folded
    assert "more of toy" in folded
    assert "Up high" in whole
    assert not fold


def test_a_requirement_that_no_test_triggers_is_pointed_out(campaign, tmp_path, spec, capsys):
    """The page links to a run that shows what its trigger lacked; others are not named there."""
    spec.write_text(
        f'{spec.read_text()}requirement Far "Up high"\n  upon level >= 50\n  then within 1 s over\n'
    )
    assert main(campaign(("low", {"level": 3.0})), ["run", "--jobs", "1", "--out", "out"]) == 0
    page = (tmp_path / "out/report.html").read_text()
    told = page.partition("triggered by no test, and so untested:")[2].partition("</p>")[0]
    assert told.count("<a ") == 1
    assert 'href="runs/toy-low.html#Far"' in told
