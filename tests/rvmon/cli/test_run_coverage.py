"""`rvmon run` with coverpoints: illegal bins, hits, goals and the database."""

import io
import json
import os
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest

from rvmon.cli import main
from rvmon.coverage.database import read
from rvmon.verdicts.report import Report

pytestmark = pytest.mark.slow

SPEC = """
spec arm "An arm"
signal near : bool
signal state : {idle, moving}
requirement A1
  upon near
  then within 1 s state == idle

coverpoint person = near {yes: true, no: false}
coverpoint arm = state {idle, moving, stops: moving => idle}
cross both = person, arm
  illegal person == yes and arm == moving
cover parked = near and state == idle
"""
WILD = "t,near,state\n0,false,idle\n1,true,moving\n1.5,,idle\n4,,moving\n"


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.rv").write_text(SPEC)
    (tmp_path / "calm.csv").write_text("t,near,state\n0,false,moving\n1,,idle\n2,true,\n3,false,\n")
    (tmp_path / "wild.csv").write_text(WILD)
    return tmp_path


def test_a_hit_of_an_illegal_bin_fails_the_run(files, says):
    assert "illegal:" not in says(0, "run", "arm.rv", "calm.csv").out
    shown = says(1, "run", "arm.rv", "wild.csv", "--junit", "j.xml", "--report", "pages").out
    line = "illegal: `yes × moving` of `both` was hit at 1 s, 2 times in all"
    assert line in shown
    (failure,) = ET.parse("j.xml").getroot().iter("failure")  # noqa: S314 - our own
    assert failure.get("message") == line
    assert line in next((files / "pages").glob("*wild*.html")).read_text()
    shown = json.loads(says(1, "run", "arm.rv", "wild.csv", "--format", "json").out)
    assert shown["illegal"] == [
        {"group": "both", "item": "yes × moving", "count": 2, "first": 10**9}
    ]
    assert shown["requirements"]["A1"]["verdict"] == "P"


def test_hits_are_shown_without_a_database(files, says):
    text = says(0, "run", "arm.rv", "calm.csv").out
    assert "person: 2 of 2 covered; hit: yes 1, no 2" in text
    assert "both: not covered: yes × stops" in text
    text = says(1, "run", "arm.rv", "calm.csv", "wild.csv", "--quiet").out
    assert "person: 2 of 2 covered; hit: yes 2, no 3" in text
    assert "both: not covered" not in text
    shown = json.loads(says(0, "run", "arm.rv", "calm.csv", "--format", "json").out)["coverage"]
    assert [group["name"] for group in shown] == ["person", "arm", "both"]
    no = {"name": "no", "kind": "goal", "goal": 1, "hits": 2, "first": 0}
    assert shown[0]["bins"][1] == no
    missed = [item["name"] for item in shown[2]["bins"] if not item["hits"]]
    assert missed == ["yes × moving", "yes × stops"]


def test_a_missing_column_of_a_coverpoint_is_an_error(files, says):
    (files / "few.csv").write_text("t,state\n0,idle\n")
    spec = SPEC.replace("  upon near\n", "  upon state == moving\n")
    (files / "arm.rv").write_text(spec)
    assert "`near`, read by person" in says(2, "run", "arm.rv", "few.csv").err
    assert main(["run", "arm.rv", "few.csv", "--allow-missing"]) == 1


@pytest.mark.parametrize("jobs", ["1", pytest.param("2", marks=pytest.mark.slow)])
def test_a_second_run_replaces_its_tests_in_the_database(files, jobs):
    command = ["run", "arm.rv", "calm.csv", "wild.csv", "--coverage", "c.db", "--jobs", jobs]
    assert main(command) == 1
    assert main(command) == 1
    coverage = read(["c.db"])
    assert [entry.record.name for entry in coverage.entries] == ["calm.csv", "wild.csv"]
    assert coverage.entries[0].record.verdicts == {"A1": "P"}


def test_a_first_hit_has_its_time_in_the_run_and_its_stamp(files, says):
    (files / "calm.csv").write_text("t,near,state\n1700000000,false,idle\n1700000000.5,true,\n")
    assert main(["run", "arm.rv", "calm.csv", "--coverage", "c.db"]) == 0
    told = " ".join(says(0, "cover", "c.db", "--bins").out.split())
    assert "calm.csv at 0.5 s (stamp 1700000000.5 s, 2023-11-14 22:13:20 UTC)" in told


def test_an_illegal_hit_on_standard_input_fails_the_run(files, monkeypatch):
    lines = ['{"t": 0, "near": true, "state": "moving"}', '{"t": 1, "state": "idle"}']
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO("\n".join(lines).encode())))
    assert main(["run", "arm.rv", "-"]) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="no limits of files")
@pytest.mark.process
@pytest.mark.parametrize("kilobytes", [0, 8])
def test_a_full_disk_is_reported_and_loses_no_earlier_results(files, kilobytes):
    """With room for no table or for some; `cover` refuses the database that is left."""
    resource = pytest.importorskip("resource")
    words = ["run", "arm.rv", "calm.csv", "--coverage", "c.db"]
    # Without this, Python would cache modules that the limit has truncated.
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}

    def limited():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes << 10, kilobytes << 10))

    def told():
        line = [sys.executable, "-m", "rvmon", *words]
        done = subprocess.run(  # noqa: S603 - our words
            line, preexec_fn=limited, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 2
        return done.stderr

    said = told()
    assert "the disk" in said
    assert "Traceback" not in said
    assert main(["cover", "c.db"]) == 2
    assert main(words) == 0
    assert main(["cover", "c.db"]) in (0, 1)
    kept = [entry.record for entry in read(["c.db"]).entries]
    told()
    assert [entry.record for entry in read(["c.db"]).entries] == kept


def test_cover_goals_are_shown_possible_or_missed_and_met_by_several_runs(put, says):
    put(
        "s.rv",
        'spec s\nsignal a : bool\nevent e\nrequirement R1 "x"\n  upon e\n  then immediately a\n'
        "cover met = e and a\ncover never = a and not a\n",
    )
    traces = [
        put(f"{name}.csv", f"t,a,e\n0,1,0\n1,{last},{last}\n")
        for name, last in (("one", "1"), ("two", "0"))
    ]
    shown = says(0, "run", "s.rv", *traces).out
    assert "met  P ✓  shown" in shown
    assert "met  I ?  not shown, still possible at the end" in shown
    assert "never  NT –  not shown" in shown
    assert "cover goal met: met, shown by 1 of 2" in shown
    assert "cover goal never: open" in shown
    text = says(0, "run", "s.rv", traces[0], "--format", "json").out
    assert json.loads(text)["goals"] == {"met": "P", "never": "NT"}
    assert Report.from_json(text).goals == {"met": "P", "never": "NT"}
