"""`rvmon run --evidence` writes an archive; `rvmon evidence` verifies it and finds changes."""

import csv
import hashlib
import io
import json
import re

import msgspec
import pytest
from tests.tools.bags import write_shop

import rvmon
from rvmon.cli import main
from rvmon.evidence import About, derived_entries, pack, unpack
from rvmon.report.trace_matrix import rows_by_item

pytestmark = pytest.mark.slow

COMMON = "signal speed : real\nevent go\n"
SPEC = """
spec base
import "../common.rv"
const T = 9 s
requirement R1 "Go slows it"
  upon go
  then within T speed < 1
  source "ISO 1, 4.2"
requirement R2
  always speed < 9
coverpoint fast = speed {slow: [0, 5], illegal reckless: (5, 100]}
"""


def forged(entries):
    """Verdicts with a pass in place of a failure, and the matrix that follows from them."""
    verdicts = entries["verdicts.csv"].replace(b"R1#1,1,F", b"R1#1,1,P")
    about = msgspec.json.decode(entries["evidence.json"], type=About)
    spec = {"": rvmon.load("specs/base.rv", const={"T": "2 s"})}
    return {"verdicts.csv": verdicts, **derived_entries(about, spec, rows_by_item(verdicts))}


@pytest.fixture
def base(tmp_path, monkeypatch):
    """A project with a specification that imports another, and three recordings, one broken."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".git").mkdir()
    (tmp_path / "specs").mkdir()
    (tmp_path / "common.rv").write_text(COMMON)
    (tmp_path / "specs" / "base.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("stamp,v,go\n0,2,\n9000,3,1\n11500,0.5,\n15000,,\n")
    (tmp_path / "b.csv").write_text("stamp,v,go\n0,2,\n9000,6,\n11500,0.5,\n")
    (tmp_path / "c.csv").write_text("stamp,v,go\n0,2,\n9000,six,\n")
    return tmp_path


TRACES = ["a.csv", "b.csv", "c.csv"]


def run(*words, out="e.zip"):
    reading = ["--time", "stamp:ms", "--map", "speed=v", "--const", "T=2 s"]
    return main(["run", "specs/base.rv", *words, *reading, "--quiet", "--evidence", out])


def verify(capsys, *words):
    """The exit code of verifying, and its output."""
    capsys.readouterr()
    code = main(["evidence", "e.zip", *words])
    told = capsys.readouterr()
    return code, told.out + told.err


def rewritten(path, change):
    """Change entries of an archive, and write it again with correct checksums."""
    entries = unpack(path)
    change(entries)
    with open(path, "wb") as file:
        file.write(pack(entries))


def test_the_same_run_writes_the_same_bytes(base):
    assert run(*TRACES) == 2
    assert run(*TRACES, "--jobs", "2", "--out", "v.csv", out="f.zip") == 2
    assert (base / "e.zip").read_bytes() == (base / "f.zip").read_bytes()


def test_an_archive_holds_everything_that_verdicts_follow_from(base, capsys):
    assert run(*TRACES, "--coverage", "c.db") == 2
    entries = unpack("e.zip")
    assert entries["spec/common.rv"] == COMMON.encode()
    assert entries["spec/specs/base.rv"] == SPEC.encode()
    about = json.loads(entries["evidence.json"])
    assert about["judging"]["const"] == ["T=2 s"]
    assert about["recordings"]["a.csv"] == hashlib.sha256((base / "a.csv").read_bytes()).hexdigest()
    assert {"numpy", "msgspec"} <= about["packages"].keys()
    assert json.loads(entries["coverage.json"])[""]["hits"]["fast"]["reckless"] == 1
    rows = list(csv.DictReader(io.StringIO(entries["matrix.csv"].decode())))
    found = [(row["requirement"], row["source"], row["by"], row["verdict"]) for row in rows]
    assert found == [
        ("R1", "ISO 1, 4.2", "a.csv", "F"),
        ("R1", "ISO 1, 4.2", "b.csv", "NT"),
        ("R1", "ISO 1, 4.2", "c.csv", ""),
        ("R2", "", "a.csv", "P"),
        ("R2", "", "b.csv", "P"),
        ("R2", "", "c.csv", ""),
        ("illegal", "", "b.csv", "F"),
    ]
    page = entries["matrix.html"].decode()
    assert "ISO 1, 4.2" in page
    assert "2 ✓ passed" in page
    assert not re.search(r"(src|href)=\"(?!#)", page), "it needs nothing but itself"
    code, told = verify(capsys, "--sample", "all")
    assert "evaluated again: 3 of 3" in told
    assert (code, told.splitlines()[-1]) == (0, "It holds.")


def test_a_bag_with_a_binding_is_verified(base, capsys):
    pytest.importorskip("rosbags")
    write_shop(base)
    words = ["run", "specs/base.rv", "bag", "--binding", "base.toml", "--quiet"]
    assert main([*words, "--evidence", "e.zip"]) < 2
    (base / "base.toml").unlink()
    assert verify(capsys)[0] == 0
    (base / "bag" / "more").write_text("")
    assert verify(capsys)[0] == 1


def test_changed_and_missing_recordings_are_reported(base, capsys):
    run(*TRACES)
    kept = (base / "b.csv").read_bytes()
    (base / "b.csv").write_bytes(kept + b"12000,1,\n")
    code, told = verify(capsys)
    assert code == 1
    assert "b.csv is not the recording that was evaluated" in told
    assert "evaluated again: 2 of 3" in told
    (base / "b.csv").unlink()
    code, told = verify(capsys)
    assert (code, "b.csv is missing" in told) == (2, True)
    (base / "b.csv").write_bytes(kept)
    assert verify(capsys)[0] == 0


def test_a_seed_selects_the_sampled_recordings(base, capsys):
    """Only a sample with a.csv reveals the forgery."""
    run(*TRACES)
    rewritten("e.zip", lambda entries: entries.update(forged(entries)))
    told = {seed: verify(capsys, "--sample", "1", "--seed", str(seed)) for seed in range(4)}
    assert all("evaluated again: 1 of 3" in said for _, said in told.values())
    assert {code for code, _ in told.values()} == {0, 1}
    assert verify(capsys, "--sample", "1", "--seed", "3") == told[3]


def of_others(entries):
    """Verdicts on a recording that was not evaluated."""
    body = entries["verdicts.csv"]
    row = body.splitlines()[1].removeprefix(b"a.csv")
    return {"verdicts.csv": body + b"b.csv" + row}


def about(**changed):
    """Another description of the run."""
    return lambda entries: {
        "evidence.json": json.dumps(json.loads(entries["evidence.json"]) | changed).encode()
    }


def longer(name):
    """An entry with one more byte."""
    return lambda entries: {name: entries[name] + b" "}


OTHER_SPEC = {"spec/specs/base.rv": SPEC.replace("speed < 9", "speed < 1").encode()}
NONE = "not an evidence archive that this rvmon"
CHANGED = {
    "verdicts": (forged, 1, "R1#1 in a.csv: verdict was P, is F"),
    "requirements": (lambda _: OTHER_SPEC, 1, "R2#1 in a.csv: verdict was P, is F"),
    "the matrix": (longer("matrix.csv"), 1, "does not follow"),
    "its page": (longer("matrix.html"), 1, "does not follow"),
    "verdicts of others": (of_others, 1, "on others: b.csv"),
    # Archives of another rvmon are checked only in part.
    "the law": (about(law=1), 2, "this rvmon has law"),
    "the programs": (about(programs={}), 2, "another rvmon"),
    "no description": (lambda _: {"evidence.json": b"{}"}, 2, NONE),
    "a later form": (lambda _: {"evidence.json": b'{"format": 9, "rvmon": "7.0"}'}, 2, NONE),
    "a name that leads out": (lambda _: {"spec/../../x": b""}, 2, "leads out of it"),
    "a file that is a folder": (lambda _: {"spec/x": b"", "spec/x/y": b""}, 2, "xists"),
    "another table": (lambda _: {"verdicts.csv": b"a,b\n"}, 2, NONE),
    "no text": (lambda _: {"verdicts.csv": b"\xff"}, 2, NONE),
}


@pytest.mark.parametrize("what", CHANGED)
def test_a_change_is_found_though_checksums_are_correct(base, capsys, what):
    change, code, told = CHANGED[what]
    run("a.csv")
    rewritten("e.zip", lambda entries: entries.update(change(entries)))
    found, said = verify(capsys)
    assert (found, told in said) == (code, True), said
    assert not (base.parent / "x").exists()


def test_no_evidence_is_written_if_a_recording_changes_during_the_run(base, capsys, monkeypatch):
    from rvmon.cli import evaluation

    judge = evaluation.judge

    def other(*words, **more):
        (base / "a.csv").write_text("stamp,v,go\n0,2,\n")
        return judge(*words, **more)

    monkeypatch.setattr(evaluation, "judge", other)
    assert run("a.csv") == 2
    assert "changed meanwhile" in capsys.readouterr().err
    assert not (base / "e.zip").exists()
