"""`rvmon cover`: what it prints, writes and compares, and its exit codes."""

import json
from pathlib import Path

import pytest
from tests.tools.covered import door_model, fill, hits_of
from tests.tools.hostile import STEERING, hostile_names

from rvmon.cli import main
from rvmon.coverage import Group, Hit, Item, Subject, TestRecord, combination, group_of, model_of
from rvmon.coverage.database import Database, read
from rvmon.language.checked.properties import BinKind
from rvmon.verdicts import Verdict


@pytest.fixture
def door(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with Database.open("door.cov") as database:
        fill(database)
    return "door.cov"


def shown(capsys, *words):
    """The exit code, and the lines of standard output without the padding of columns."""
    code = main(["cover", *words])
    lines = capsys.readouterr().out.splitlines()
    return code, [" ".join(line.split()) for line in lines]


def covered(folder, *groups):
    """The path of a database with groups and without hits."""
    path = str(folder / "a.cov")
    with Database.open(path) as database:
        database.declare(model_of(groups))
    return path


def test_a_group_without_goals_is_no_row(tmp_path, capsys):
    """Neither the terminal nor the page calls that 100 %; requirements keep their order."""
    path = tmp_path / "base.cov"
    groups = [group_of("near", Subject.COVERPOINT, [Item("yes")])]
    groups.append(group_of("pairs", Subject.TRANSITIONS, []))
    groups.append(group_of("seen", Subject.COVERPOINT, [Item("light", BinKind.IGNORE)]))
    groups += [group_of(name, Subject.REQUIREMENT, [Item("passed")]) for name in ("T2", "T10")]
    judged = {"T10": Verdict.PASS, "T2": Verdict.FAIL}
    with Database.open(path) as database:
        database.declare(model_of(groups))
        database.record(TestRecord("one", when=0, verdicts=judged), {"seen": {"light": Hit(1)}})
    page = tmp_path / "base.html"
    code, lines = shown(capsys, str(path), "--report", str(page))
    assert code == 0
    assert not [line for line in lines if line.startswith(("pairs", "seen"))]
    assert "near coverpoint 0 of 1 0 % ░░░░░░░░░░░░░░░░░░░░" in lines
    assert "0 of 1</td>" in page.read_text()
    assert "0 of 0</td>" not in page.read_text()
    verdicts = [line.split()[0] for line in lines if line.startswith("T") and "·" in line]
    assert verdicts == ["T2", "T10"]


@pytest.mark.slow
def test_items_that_cannot_be_hit_are_listed_with_their_reason(door, capsys):
    """They do not count as holes or in the share; a hit of one is an error."""
    with Database.open(door) as database:
        database.exclude("near", "reach", "a fence is there")
        database.exclude("near", "far", "a fence is there")
        database.exclude("situation", "yes × reach", "a fence is there")
    code, lines = shown(capsys, door, "--holes", "--strict")
    assert code == 1
    assert "4 holes:" not in lines
    assert "near coverpoint 1 of 1 100 % ████████████████████" in lines
    heading = lines.index("excluded because they cannot be hit:")
    told = "a fence is there: near: reach, near: far, situation: yes × reach"
    assert lines[heading + 1] == told
    assert main(["cover", door, "--require", "1%"]) == 1  # something illegal was hit
    _, lines = shown(capsys, door, "--bins=near")
    assert "reach (cannot be hit) –" in lines
    with Database.open(door) as database:
        database.exclude("gaze", "yes", "nobody looks")
    _, lines = shown(capsys, door)
    at = lines.index("hit, but declared unreachable:")
    assert lines[at + 1] == "gaze: yes 3 hits by 2 tests, first calm-1 at 1 s"


@pytest.mark.slow
def test_ucis_output_is_valid_by_its_schema(door, tmp_path, says):
    ucis = pytest.importorskip("ucis")
    etree = pytest.importorskip("lxml.etree")
    with Database.open(door) as database:
        database.exclude("near", "reach", "a fence is there")
    path = tmp_path / "door.xml"
    assert main(["cover", door, "--ucis", str(path)]) == 0
    schema = Path(ucis.__file__).parent / "xml" / "schema" / "ucis.xsd"
    document = etree.parse(path)
    etree.XMLSchema(etree.parse(schema)).assertValid(document)
    bins = {item.get("name"): item for item in document.iter("coverpointBin", "crossBin")}
    counts = {name: item.find(".//contents").get("coverageCount") for name, item in bins.items()}
    assert (counts["yes"], counts["no × touch"], counts["far"]) == ("3", "1", "0")
    assert [one.text for one in bins["no × far"].iter("index")] == ["1", "2"]
    assert bins["no × touch"].get("type") == "illegal"
    assert bins["reach"].get("type") == "ignore"
    assert bins["reach"].find("userAttr").text == "a fence is there"
    (status,) = document.xpath("//*[@logicalName='wild-2']/@testStatus")
    assert status == "false"
    says(2, "cover", door, "--ucis", tmp_path / "no" / "x.xml")


def test_a_cross_of_three_has_nested_rows(tmp_path, capsys, monkeypatch):
    axes = {"x": ["a", "b"], "y": ["c", "d"], "z": ["e", "f"]}
    names = [combination([x, y, z]) for x in "ab" for y in "cd" for z in "ef"]
    path = covered(
        tmp_path, Group("xyz", Subject.CROSS, {name: Item(name) for name in names}, axes=axes)
    )
    with Database.open(path) as database:
        database.record(TestRecord("t"), hits_of(("xyz", names[3]), count=12345))
    _, lines = shown(capsys, path, "--bins")
    grid = lines.index("x y e f")
    assert lines[grid + 2 : grid + 6] == ["a c 0 0", "d 0 12,345", "b c 0 0", "d 0 0"]
    monkeypatch.setenv("COLUMNS", "15")
    _, lines = shown(capsys, path, "--bins")
    assert "x y e f" not in lines


def test_the_items_of_a_huge_cross_are_a_list(tmp_path, capsys):
    """The grid of these axes would have 10^12 cells."""
    axes = {axis: [str(number) for number in range(100)] for axis in "uvwxyz"}
    name = combination(["7"] * 6)
    path = covered(tmp_path, Group("far", Subject.CROSS, {name: Item(name)}, axes=axes))
    code, lines = shown(capsys, path, "--bins", "--report", str(tmp_path / "a.html"))
    assert code == 0
    assert f"{name} 0" in lines


def test_json_has_groups_illegal_hits_tests_and_an_order(door, says):
    document = json.loads(says(0, "cover", door, "--format", "json").out)
    assert document["share"] == pytest.approx(0.4583, abs=1e-4)
    gaze = document["groups"][0]
    assert (gaze["name"], gaze["covered"], gaze["items"]) == ("gaze", 2, 2)
    assert gaze["bins"][0]["first"] == {"test": 0, "name": "calm-1", "at": 1_000_000_000}
    assert document["illegal"] == [["situation", "no × touch"]]
    assert document["tests"][3]["added"] == [["gaze", "no"]]
    order = [test["name"] for test in document["shortest_known_order"]]
    assert order == ["calm-2", "wild-2", "wild-1"]
    assert document["compared"] is None


@pytest.mark.slow
def test_a_missed_share_an_illegal_hit_and_a_loss_fail(door, says):
    hits = hits_of(("near", "touch"), ("situation", "no × far"))
    with Database.open(door) as database:
        database.record(TestRecord("calm-1", "week 2"), hits)
    week_2 = ["cover", door, "--campaign", "week 2"]
    says(1, "cover", door, "--require", "40%")  # an illegal hit
    says(1, "cover", door, "--strict")
    says(0, *week_2, "--require", "20", "--strict")
    says(1, *week_2, "--require", "20.9%")
    says(1, *week_2, "--strict", "--compare", "week 1")  # a loss


def test_campaigns_are_compared(door, capsys, says):
    later = "later.cov"
    with Database.open(later) as database:
        database.declare(door_model())
        database.record(
            TestRecord("calm-1", "week 2", "random", seed=1, verdicts={"D1": "F"}),
            hits_of(("near", "reach"), ("gaze", "yes")),
        )
    _, lines = shown(capsys, later, "--compare", door)
    at = lines.index(f"since {door}: 46 % → 21 %")
    assert lines[at + 1] == "lost:"
    lost, at = at + 2, lines.index("newly covered:")
    told = ["gaze: no", "near: touch", "situation: yes × touch", "D1: triggered"]
    assert lines[lost:at] == told
    assert lines[at + 1 : at + 4] == ["near: reach", "verdicts that changed:", "calm-1 D1 P → F"]
    _, both = shown(capsys, door, later, "--campaign", "week 2", "--compare", "week 1")
    assert "since week 1: 46 % → 21 %" in both
    assert "by --campaign" in says(2, "cover", door, later, "--compare", "week 1").err
    assert "did you mean `week 1`?" in says(2, "cover", door, "--campaign", "weak 1").err


def test_a_conflict_of_goals_changes_no_database(door, tmp_path, says):
    other = covered(tmp_path, group_of("gaze", Subject.COVERPOINT, [Item("yes", goal=9)]))
    told = says(2, "cover", door, other, "--merge", tmp_path / "out.cov").err
    assert "item `yes` of group `gaze` is a goal of 9 hits here, a goal of 1 hit in" in told
    assert not (tmp_path / "out.cov").exists()
    assert main(["cover", door, "--merge", other]) == 2
    assert len(read([other]).entries) == 0


@pytest.mark.slow
def test_escapes_in_names_do_not_reach_the_terminal(tmp_path, says):
    names = list(hostile_names(40))
    axes = {names[0]: names, names[1]: names[:2]}
    crossed = [combination([one, two]) for one in names for two in names[:2]]
    path = covered(
        tmp_path,
        group_of(names[5], Subject.COVERPOINT, [Item(name) for name in names]),
        Group(names[6], Subject.CROSS, {name: Item(name) for name in crossed}, axes=axes),
    )
    with Database.open(path) as database:
        for name in names:
            verdicts = {name: "F"}
            record = TestRecord(name, name, name, error=name, ending="hung", verdicts=verdicts)
            database.record(record, hits_of((names[5], name)))
            database.explain(names[6], crossed[0], name)
    for words in (["--holes", "--bins", "--tests"], ["--format", "json"]):
        assert not STEERING.search(says(0, "cover", path, *words).out)


def test_an_empty_database_is_shown_and_reaches_no_share(tmp_path, capsys, says):
    """A gate does not pass because nothing was declared to be covered."""
    path = str(tmp_path / "a.cov")
    Database.open(path).close()
    code, lines = shown(capsys, path, "--holes", "--bins", "--tests")
    assert code == 0
    assert lines[0] == f"{path} 0 tests"
    assert "no holes" in lines
    assert "there is nothing to cover" in says(1, "cover", path, "--require", "0%").err
