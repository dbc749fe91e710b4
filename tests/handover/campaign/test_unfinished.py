"""An interrupted campaign resumes and gives the result of an uninterrupted one."""

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from msgspec.structs import replace

from handover.cli import main
from rvmon.cdv import campaign_text
from rvmon.cdv.play import execute
from rvmon.cdv.resume import NAME
from rvmon.cli import campaign_run
from rvmon.coverage.database import read
from rvmon.execute.journal import entries

pytestmark = pytest.mark.campaign

RUN = ("run", "--strategy", "constrained", "--seed", "8", "--legacy", "--out", "out")
WORDS = (*RUN, "--tests", "6", "--jobs", "1")
"""In which signals of a test get lost, so that it has two outcomes."""


def files(folder):
    return {
        path.relative_to(folder): re.sub(
            rb'("seconds": |simulated in |\bin )[\d.]+', b"", path.read_bytes()
        )
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".db"
    } | {
        path.relative_to(folder): [
            (replace(entry.record, seconds=0.0), entry.digest) for entry in read([path]).entries
        ]
        for path in folder.rglob("*.db")
    }


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An uninterrupted campaign: its files, and its journal before it was removed."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        kept = []

        def write_tables(*arguments):
            kept.append(Path("out", NAME).read_bytes())
            real(*arguments)

        real = campaign_text.write_tables
        patch.setattr(campaign_text, "write_tables", write_tables)
        assert main(WORDS) == 0
    return files(folder / "out"), kept[0]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path / "out"


@pytest.fixture
def played(monkeypatch):
    """The numbers of finished tests, as printed."""
    told = []

    def telling(plan, **options):
        return execute(plan, **{**options, "progress": told.append})

    monkeypatch.setattr(campaign_run, "execute", telling)
    return told


def left(folder, journal):
    """Write the folder that a killed campaign leaves."""
    folder.mkdir()
    (folder / NAME).write_bytes(journal)


@pytest.mark.parametrize(
    ("tests", "torn"),
    [
        pytest.param(0, b"", id="at the start"),
        pytest.param(0, b"0", id="in the first test"),
        pytest.param(3, b"8f3a2c01 {", id="in another test"),
        pytest.param(5, b"\x00" * 64, id="in a file that was not whole on the disk"),
        pytest.param(6, b"", id="behind the last test"),
    ],
)
def test_it_comes_to_the_same_wherever_it_was_killed(whole, here, played, capsys, tests, torn):
    known, journal = whole
    lines = journal.splitlines(keepends=True)
    assert len(lines) == 1 + 6
    left(here, b"".join(lines[: 1 + tests]) + torn)
    assert main(WORDS) == 0
    assert files(here) == known
    assert played == list(range(tests + 1, 7))
    assert (f"{tests} of 6 tests were played before" in capsys.readouterr().err) == (tests > 0)


@pytest.mark.parametrize("first", [pytest.param(3, id="damage"), pytest.param(5, id="of two")])
def test_tests_after_a_damaged_entry_are_played_again(whole, here, played, first):
    """So are entries that two campaigns wrote at once, from their first overlap."""
    known, journal = whole
    lines = journal.splitlines(keepends=True)
    lines[first:first] = (
        [lines[4]] if first == 5 else [lines.pop(3).replace(b"seconds", b"Seconds")]
    )
    left(here, b"".join(lines))
    assert main(WORDS) == 0
    assert files(here) == known
    assert played[0] == first


def test_shards_are_joined(whole, here, played, capsys):
    """Tests that an interrupted shard has played are not repeated; missing ones are played."""
    assert main((*WORDS, "--shard", "2/2")) == 0
    assert main((*WORDS, "--shard", "1/2")) == 0
    told = capsys.readouterr()
    assert "shard 1/2: 3 of 6 tests were finished" in " ".join(told.out.split())
    journal = here / "unfinished.shard-1-of-2.journal"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:3]))
    assert sorted(path.suffix for path in here.iterdir()) == [".journal", ".journal"]
    played.clear()
    assert main(WORDS) == 0
    assert files(here) == whole[0]
    assert len(played) == 1


def test_an_interrupted_campaign_keeps_what_is_finished_and_goes_on(
    whole, here, monkeypatch, capsys
):
    """Exit code 130; the table gives the number of tests counted and planned."""

    def interrupted(plan, **options):
        def press_ctrl_c(count):
            if count == 3:
                signal.raise_signal(signal.SIGINT)

        return execute(plan, **{**options, "progress": press_ctrl_c})

    with monkeypatch.context() as patch:
        patch.setattr(campaign_run, "execute", interrupted)
        assert main(WORDS) == 130
    told = capsys.readouterr()
    assert "the same command plays the rest" in told.err
    assert "the tables are partial" in told.out
    content = json.loads((here / "table.json").read_text())
    assert content["partial"] == {"why": "interrupted", "finished": 3, "planned": 6}
    assert content["robots"]["legacy"]["strategies"]["constrained"]["tests"] == 3
    assert len(list((here / "tests").iterdir())) == 3
    assert "PARTIAL" in (here / "table.txt").read_text()
    assert "Partial: interrupted" in (here / "report.html").read_text()
    assert main(WORDS) == 0
    assert files(here) == whole[0]


@pytest.mark.skipif(sys.platform == "win32", reason="needs the signals of POSIX")
def test_a_campaign_that_is_killed_goes_on(whole, here):
    words = (*RUN, "--tests", "6", "--jobs", "2")
    here.mkdir()
    for tests in (2, 4):
        with subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, "-m", "handover.cli", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as process:
            journal = here / NAME
            while process.poll() is None and len(entries(journal) or ()) <= tests:
                time.sleep(0.01)
            process.kill()
    assert main(words) == 0
    assert files(here) == whole[0]


@pytest.mark.parametrize(
    "other",
    [("--seed", "2"), ("--tests", "5"), ("--strategy", "pseudorandom"), ("--no-monitors",)],
)
def test_another_campaign_is_refused(whole, here, capsys, other):
    left(here, whole[1])
    assert main([*WORDS, *other]) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert f"{Path('out', NAME)} holds another campaign" in told
    assert (
        "run --tests 6 --seed 8 --robot legacy --strategy constrained --out out` finishes" in told
    )
    assert "remove it to give that up, or name another --out" in told
    assert files(here) == {Path(NAME): whole[1]}


def test_other_requirements_are_another_campaign(here, capsys):
    """Also if their file has the same name."""
    here.mkdir()
    mine = here.parent / "mine.rv"
    mine.write_text("spec mine\nevent done\nrequirement R1\n  eventually within 1 s done\n")
    (here / "table.txt").mkdir()
    words = [*WORDS, "--spec", "mine.rv"]
    assert main(words) == 3  # the table cannot be written
    kept = (here / NAME).read_bytes()
    mine.write_text(mine.read_text().replace("1 s", "2 s"))
    capsys.readouterr()
    assert main(words) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert "holds this campaign before its tests, requirements or programs changed" in told
    assert (here / NAME).read_bytes() == kept


@pytest.mark.parametrize("content", [b"", b"mine\n", b"2144df1c ok\n"])
def test_a_file_that_is_no_journal_stays(here, capsys, content):
    """It may be somebody's file."""
    left(here, content)
    assert main(WORDS) == 2
    assert "holds no campaign" in capsys.readouterr().err
    assert (here / NAME).read_bytes() == content
