"""The example of a second robot, run from the command line."""

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[3] / "examples" / "base_and_people"

pytestmark = pytest.mark.process


def run(*words, cwd, folder=EXAMPLE):
    return subprocess.run(  # noqa: S603 - our own program
        [sys.executable, str(folder / "campaign.py"), *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=cwd,
    )


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A folder with a campaign's files in `out`, and the output of the command."""
    folder = tmp_path_factory.mktemp("example")
    words = ("run", "--tests", "20", "--jobs", "1", "--out", "out", "--junit", "junit.xml")
    return folder, run(*words, cwd=folder)


def test_the_unmodified_robot_passes(played):
    """Exit code 0: the planted fault was found, as its test expects."""
    folder, done = played
    assert (done.returncode, done.stderr) == (0, "")
    assert "4 of 4 directed tests ended as they should" in done.stdout
    table = json.loads((folder / "out" / "table.json").read_text())
    strategies = table["robots"]["base"]["strategies"]
    assert [one["tests"] for one in strategies.values()] == [20, 20, 3]
    assert all(one["statements"]["percent"] == 100 for one in strategies.values())
    root = ET.parse(folder / "junit.xml").getroot()  # noqa: S314 - our own
    assert len(list(root.iter("testcase"))) == 45  # the last one: no unreachable item is hit
    assert not list(root.iter("failure"))


def test_all_files_are_there_and_lead_somewhere(played):
    out = played[0] / "out"
    names = {path.name for path in out.iterdir()}
    tables = {f"table.{ending}" for ending in ("txt", "csv", "tex", "json")}
    covered = {"coverage.db", "coverage.html", "code.lcov", "cobertura.xml"}
    assert names == {*tables, *covered, "report.html", "tests", "runs"}
    for page in (out / "report.html", out / "coverage.html", *(out / "runs").iterdir()):
        for address in re.findall(r'href="([^"#]+)', page.read_text()):
            assert (page.parent / address).exists(), (page.name, address)


def test_a_test_is_replayed(played):
    folder, _ = played
    done = run("replay", "out/tests/brakes-late.json", "--out", "again", cwd=folder)
    assert done.returncode == 1
    assert "B2 F" in done.stdout
    names = {path.name for path in (folder / "again").iterdir()}
    assert names == {"brakes-late.html", "brakes-late.jsonl"}


def test_a_fault_in_the_robot_fails(tmp_path):
    for path in EXAMPLE.glob("*.*"):
        text = path.read_text().replace("stop_m = 1.5", "stop_m = 0.3")
        (tmp_path / path.name).write_text(text)
    done = run("run", "--tests", "10", "--jobs", "1", cwd=tmp_path, folder=tmp_path)
    assert done.returncode == 1
    assert "not as expected: gives-way (base): B2 is F, not P" in done.stderr
    assert "(base): B2#1 F at" in done.stderr


def test_it_closes(tmp_path):
    words = ("close", "--tests", "150", "--jobs", "1", "--seed", "2", "--out", "out")
    done = run(*words, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "100 % covered: 65 of 65 goals met" in done.stdout
    closing = json.loads((tmp_path / "out" / "closing.json").read_text())
    assert (len(closing["argued"]), closing["open"], closing["wrong"]) == (10, [], [])
    page = (tmp_path / "out" / "report.html").read_text()
    assert '<th scope="row">wait → slow</th>' in page
    assert "drive → wait" not in page  # it cannot be hit, so it is not a hole of the suite


def test_it_is_small():
    lines = sum(len(path.read_text().splitlines()) for path in EXAMPLE.glob("*.py"))
    assert lines <= 190
