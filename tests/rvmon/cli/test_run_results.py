"""`rvmon run` writes tables of verdicts, resumes interrupted runs and accepts known failures."""

import json
import os
import xml.etree.ElementTree as ET

import pytest
from tests.tools.logs import write_can

from rvmon.cli import main
from rvmon.execute import journal
from rvmon.verdicts.table_file import read_results

SPEC = """signal p : bool
requirement R1
  always p
requirement R2
  upon not p then within 1 s p
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A recording that passes, one that fails, and a broken one."""
    (tmp_path / "s.rv").write_text(SPEC)
    (tmp_path / "good.csv").write_text("t,p\n0,1\n5,1\n")
    (tmp_path / "bad.csv").write_text("t,p\n0,1\n5,0\n9,0\n")
    (tmp_path / "cut.csv").write_text("t,p\n0,1\n5,maybe\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def interrupted(monkeypatch, words):
    """Interrupt a run when it is about to write its results."""

    def full(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("rvmon.verdicts.table_file.write_whole", full)
        assert main(words) == 130


@pytest.mark.slow
def test_a_table_has_the_verdicts_of_the_last_run_and_errors(folder):
    assert main(["run", "s.rv", "good.csv", "--out", "v.csv"]) == 0
    assert main(["run", "s.rv", "good.csv", "bad.csv", "--out", "v.csv"]) == 1
    found = [(row.recording, row.requirement, row.verdict) for row in read_results("v.csv")]
    assert found == [
        ("good.csv", "R1", "P"),
        ("good.csv", "R2", "NT"),
        ("bad.csv", "R1", "F"),
        ("bad.csv", "R2", "F"),
    ]
    assert main(["run", "s.rv", "good.csv", "cut.csv", "--out", "v.csv"]) == 2
    broken = [row for row in read_results("v.csv") if row.recording == "cut.csv"]
    assert "maybe" in broken[0].error
    assert not (folder / "v.csv.unfinished").exists()


@pytest.mark.slow
@pytest.mark.parametrize("resume", [True, False])
def test_a_resumed_run_gives_the_results_of_a_whole_one(folder, says, monkeypatch, resume):
    words = ["run", "s.rv", "good.csv", "bad.csv", "--out", "v.csv"]
    whole, table = says(1, *words).out, (folder / "v.csv").read_text()
    (folder / "v.csv").unlink()
    interrupted(monkeypatch, words)
    assert len(journal.entries(folder / "v.csv.unfinished")) == 3
    (folder / "good.csv").write_text("t,p\n0,1\n5,1\n\n")
    told = says(1, *words, *["--resume"] if resume else [])
    assert told.out == whole
    assert ("1 of 2 recordings were evaluated before" in told.err) is resume
    assert (folder / "v.csv").read_text() == table


@pytest.mark.slow
@pytest.mark.parametrize(("changed", "kept"), [("a.log", "1 of 2 recordings"), ("car.dbc", "")])
def test_a_changed_file_is_evaluated_again(folder, says, monkeypatch, changed, kept):
    """Even with its old size and time; a changed database of CAN messages affects all logs."""
    pytest.importorskip("can")
    for name in ("a.log", "b.log"):
        write_can(folder / name, [(1_000_000, 0.25, 1), (2_000_000, 0.25, 1)])
    spec = "signal Drive.speed : real\nrequirement R\n  always Drive.speed < 1"
    (folder / "drive.rv").write_text(spec)
    words = ["run", "drive.rv", "a.log", "b.log", "--out", "v.csv"]
    interrupted(monkeypatch, words)
    other = folder / changed
    times, text = other.stat(), other.read_text()
    other.write_text(text.replace("0000803E", "00008040").replace("(1,0)", "(8,0)"))
    assert len(text) == other.stat().st_size
    os.utime(other, ns=(times.st_atime_ns, times.st_mtime_ns))
    told = says(1, *words, "--resume").err
    assert kept in told
    assert ("evaluated before" in told) is bool(kept)


@pytest.mark.slow
def test_shards_are_joined_and_missing_or_broken_results_evaluated(folder, says):
    recordings = ["good.csv", "bad.csv", "cut.csv", "more.csv", "last.csv"]
    for copy in recordings[3:]:
        (folder / copy).write_text((folder / "bad.csv").read_text())
    words = ["run", "s.rv", *recordings, "--out"]
    assert main([*words, "whole.csv"]) == 2
    assert main([*words, "v.csv", "--shard", "1/3"]) == 1
    assert main([*words, "v.csv", "--shard", "3/3"]) == 2
    parts = [[row.recording for row in read_results(part)] for part in folder.glob("v.shard-*.csv")]
    assert sorted(map(set, parts), key=len) == [{"cut.csv"}, {"good.csv", "more.csv"}]
    (folder / "more.csv").unlink()  # a recording of a finished shard may be on another machine
    assert "2 of 5 recordings were evaluated before" in says(2, *words, "v.csv", "--resume").err
    assert (folder / "v.csv").read_text() == (folder / "whole.csv").read_text()
    assert not list(folder.glob("*.unfinished"))


@pytest.mark.slow
@pytest.mark.parametrize("also", [[], ["bad.csv"]])
def test_recordings_that_cannot_be_evaluated_are_counted(folder, says, also):
    words = ["run", "s.rv", "good.csv", "cut.csv", *also]
    assert f"{2 + len(also)} recordings, 1 cannot be evaluated\n" in says(2, *words).out


@pytest.mark.slow
def test_results_of_another_specification_are_refused(folder, says):
    words = ["run", "s.rv", "good.csv", "bad.csv", "--out", "v.csv"]
    assert main([*words, "--shard", "2/2"]) == 1
    (folder / "s.rv").write_text(SPEC.replace("1 s", "2 s"))
    told = says(2, *words, "--resume").err
    assert "v.shard-2-of-2.csv.unfinished" in told
    assert "was started with another specification" in told
    says(1, *words)


@pytest.mark.slow
def test_each_of_many_failures_has_a_reason(folder):
    """Also those of which no explanation is cached."""
    rows = "".join(f"{t},{t % 3 > 0:d}\n" for t in range(999))
    (folder / "many.csv").write_text(f"t,p\n{rows}")
    assert main(["run", "s.rv", "many.csv", "--out", "v.csv"]) == 1
    reasons = [row.reason for row in read_results("v.csv") if row.verdict == "F"]
    assert (len(reasons), len({*reasons})) == (333, 333)


@pytest.mark.slow
def test_known_failures_fail_no_run_until_their_date(folder, says):
    known = folder / "known.toml"
    known.write_text(
        '[[known]]\nrequirement = "R1"\nreason = "worn"\nuntil = 2999-01-01\n'
        '[[known]]\nrequirement = "R2"\nreason = "slow"\nuntil = 2999-01-01\n'
    )
    words = ["run", "s.rv", "good.csv", "bad.csv", "--known", "known.toml"]
    told = says(0, *words, "--junit", "j.xml", "--coverage", "c.db", "--report", "pages").err
    assert "R1 in bad.csv failed as known: worn (until 2999-01-01)" in told
    suite = ET.parse(folder / "j.xml").getroot()[1]  # noqa: S314 - ours
    assert (suite.get("failures"), suite.get("skipped")) == ("0", "2")
    assert suite[0][0].get("message").startswith("known: worn (until 2999-01-01); F: attempt 1")
    index = (folder / "pages" / "index.html").read_text()
    assert "1 fail as known, 1 not triggered" in index
    assert main(["cover", "c.db", "--strict"]) == 0
    known.write_text(known.read_text().replace("2999", "1999", 1))
    assert "R1 (worn) was known to fail until 1999-01-01, and still fails" in says(1, *words).err


def test_the_index_of_pages_lists_failures_first(folder):
    assert main(["run", "s.rv", "good.csv", "bad.csv", "cut.csv", "--report", "pages"]) == 2
    index = (folder / "pages" / "index.html").read_text()
    places = [index.index(f'data-name="{name}.csv') for name in ("cut", "bad", "good")]
    assert places == sorted(places)
    assert "cannot be evaluated: " in index
    assert 'href="bad.html#R1"' in index
    assert "← all recordings" in (folder / "pages" / "bad.html").read_text()
    assert 'class="filters" hidden="hidden"' in index


def test_a_worse_verdict_than_in_an_earlier_table_fails_the_comparison(folder, says):
    main(["run", "s.rv", "good.csv", "--out", "old.csv"])
    (folder / "good.csv").write_text((folder / "bad.csv").read_text())
    main(["run", "s.rv", "good.csv", "--out", "new.csv"])
    found = json.loads(says(1, "compare", "old.csv", "new.csv", "--format", "json").out)
    assert [change["change"] for change in found["differences"]] == ["fails now", "fails now"]
    assert "fixed" in says(0, "compare", "new.csv", "old.csv").out
    head, first, _ = (folder / "old.csv").read_text().splitlines()
    (folder / "one.csv").write_text(f"{head}\n{first}\n")
    assert says(0, "compare", "one.csv", "old.csv").out.endswith("\n1 verdict as before\n")
    (folder / "none.csv").write_text(f"{head}\n")
    told = says(2, "compare", "old.csv", "none.csv").err
    assert "good.csv is in only one of them: nothing was compared" in told
