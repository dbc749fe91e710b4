"""The pages of the documentation show what is: their specifications, programs and commands run."""

import csv
import re

import pytest
from tests.docs.pages import OWN_TESTS, PAGES, ROOT, Runner, blocks, own_test

import rvmon

RUN = [page for page in PAGES if not own_test(page) and list(blocks(page))]


def names_for(page, folder):
    """What a page takes for granted: files in its folder, and names that its programs know."""
    match page:
        case "README.md":
            return {"stream": stream_of(ROOT / "examples" / "base.csv")}
        case "docs/how-to/judge-a-ros-bag.md":
            pytest.importorskip("rosbags")
            from tests.tools.bags import drive, write_ros2

            write_ros2(folder / "monday", drive(stops_in_s=0.4), "mcap")
            (folder / "runs").mkdir()
            write_ros2(folder / "runs" / "tuesday", drive(stops_in_s=0.6), "sqlite3")
        case "docs/how-to/watch-a-running-robot.md":
            pytest.importorskip("gymnasium")
            text = "signal angle : real\nrequirement P1\n  always abs(angle) < 0.2\n"
            (folder / "pole.rv").write_text(text)
            return {"spec": rvmon.load(ROOT / "specs" / "handover.rv")}
        case "docs/reference/coverage.md":
            points = (
                "coverpoint gaze = g {yes: true}\ncoverpoint near = d {touch: true, reach: false}\n"
            )
            (folder / "robot.rv").write_text(f"signal g, d : bool\n{points}")
            for name in ("monday", "tuesday", "grasp-17"):
                (folder / f"{name}.csv").write_text("t,g,d\n0,true,false\n")
    return {}


def stream_of(path):
    """A recording as a robot would give it: instants in seconds, and what changed."""
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            t, stop = float(row.pop("t")), row.pop("stop_request")
            values = {name: float(value) for name, value in row.items() if value}
            yield t, values | ({"stop_request": True} if stop else {})


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN)
def test_the_page_is_true(page, tmp_path, monkeypatch, capsys):
    """Files are written, commands and programs run in the page's order, and print what it says."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)  # which tests that run side by side have
    runner = Runner(tmp_path, capsys.readouterr, names_for(page, tmp_path))
    for block in blocks(page):
        runner.run(block)


def test_pages_with_a_test_of_their_own_have_it():
    assert all((ROOT / test).exists() for test in OWN_TESTS.values())


def test_links_lead_somewhere():
    lost = []
    for page in PAGES:
        text, folder = (ROOT / page).read_text("utf-8"), (ROOT / page).parent
        text = re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)
        files = [one for one in re.findall(r"\]\(([^)#]+)", text) if not re.match("https?:", one)]
        lost += [(page, file) for file in files if not (folder / file).exists()]
    assert not lost


NEWCOMERS = [page for page in PAGES if page.startswith("docs/how-to/add-a")]
NEW = {"src/rvmon/recordings/tsv_rows.py"}
"""Files that the examples of these pages would add."""


@pytest.mark.parametrize("page", NEWCOMERS)
def test_what_a_newcomer_is_led_to_is_there(page):
    """Each file of the project exists, and has the names that stand in brackets behind it."""
    text = (ROOT / page).read_text("utf-8")
    named = re.findall(r"`((?:src|tests|fuzz)/[\w/.-]+)`(?:\s\(((?:`\w+`(?:, )?)+)\))?", text)
    assert named
    for path, names in named:
        assert (ROOT / path).exists() or path in NEW, path
        for name in re.findall(r"\w+", names):
            assert name in (ROOT / path).read_text("utf-8"), path
    assert not any((ROOT / path).exists() for path in NEW)


def test_each_way_to_lose_something_has_a_test():
    """The last cell of each row of what is lost names tests that there are."""
    files = [path.read_text("utf-8") for path in (ROOT / "tests" / "rvmon").rglob("test_*.py")]
    there = {name for text in files for name in re.findall(r"^def (test_\w+)", text, re.MULTILINE)}
    text = (ROOT / "docs" / "reference" / "what-is-lost.md").read_text("utf-8")
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    shown = {fault: last.split("; ") for fault, _, last in rows if fault != "fault"}
    assert len(shown) > 30
    for fault, tests in shown.items():
        assert there.issuperset(f"test_{one.replace(' ', '_')}" for one in tests), fault
