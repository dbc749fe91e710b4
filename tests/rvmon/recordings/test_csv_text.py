"""Chunks of a text are read ahead by threads, without a visible difference."""

import threading
from collections import deque

import pytest

import rvmon
from rvmon.recordings import places
from rvmon.recordings.csv_text import read_ahead

SPEC = rvmon.loads("spec s\nsignal x : real\nrequirement R\n  always x < 1e300\n")
NUMBER = "0.1000000000000000055511151231257827021181583404541015625"


def named(name):
    """The reading threads."""
    return [one for one in threading.enumerate() if one.name.startswith(name)]


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A recording of several chunks, and the place to damage."""
    monkeypatch.setattr(places, "BLOCK", 4096)
    path = tmp_path / "a.csv"
    path.write_text("t,x\n" + "".join(f"{t},{NUMBER}\n" for t in range(1000)))
    return path


def test_numbers_that_python_reads_are_read_ahead(written):
    samples = list(SPEC.recording(written))
    assert [one.values["x"] for one in samples] == [0.1] * 1000


def test_what_is_no_text_is_told_in_its_turn(written):
    with open(written, "ab") as file:
        file.write(b"1000,\xff\n")
    found = deque()
    place = written.stat().st_size - 2
    with pytest.raises(rvmon.TraceError, match=f"not UTF-8 text .*at byte {place}\\)"):
        found.extend(SPEC.recording(written))
    assert len(found) > 900


@pytest.mark.parametrize("block", range(5, 12))
def test_the_place_of_what_is_no_text_is_that_in_the_file(block, tmp_path, monkeypatch):
    monkeypatch.setattr(places, "BLOCK", block)
    path = tmp_path / "a.csv"
    path.write_bytes(b"t,x,\xc3\xbc\n0,1,\xe2\x82\xac\n1,2,\xe2\x82!\n")
    with pytest.raises(rvmon.TraceError, match=r"at byte 19\)"):
        list(SPEC.recording(path))


def test_who_stops_reading_leaves_no_thread(written):
    samples = iter(SPEC.recording(written))
    for _ in range(500):
        next(samples)
    assert named("rvmon-reads")
    samples.close()
    assert not named("rvmon-reads")


def test_faults_of_who_reads_are_raised_in_their_turn():
    found = read_ahead(iter([b"1\n", b"x\n", b"2"]), int)
    first, second, third = found
    assert first[1]() == 1
    with pytest.raises(ValueError, match="x"):
        second[1]()
    assert third == (b"2", None)


@pytest.mark.parametrize("separator", [",", ";", " "])
@pytest.mark.parametrize("ending", ["\n", "\r"])
@pytest.mark.parametrize("block", [1 << 20, 4096])
def test_a_block_never_written_is_reported(tmp_path, monkeypatch, separator, ending, block):
    """It joins the lines at its start and end to a row that looks valid."""
    monkeypatch.setattr(places, "BLOCK", block)
    rows = [separator.join((str(t), "5" if t == 601 else "1", "note")) for t in range(1000)]
    text = ending.join((separator.join(("t", "x", "by")), *rows, "")).encode()
    path = tmp_path / "a.csv"
    path.write_bytes(text)
    spec = rvmon.loads("signal x : real\nrequirement R\n  always x < 2\n")
    assert spec.evaluate(path).verdicts["R"] == "F"
    [first, last] = (text.index(rows[t].encode()) + len(rows[t]) - 2 for t in (600, 601))
    path.write_bytes(text[:first] + bytes(last - first) + text[last:])
    found = deque()
    with pytest.raises(rvmon.TraceError, match=r"a\.csv: line 602: there are zero bytes"):
        found.extend(spec.recording(path))
    assert [one.t for one in found] == [t * 10**9 for t in range(len(found))]
    (tmp_path / "topics.toml").write_text("")
    with pytest.raises(rvmon.TraceError, match=r"a\.csv: line 602: there are zero bytes"):
        rvmon.loads("signal a.x : real\nrequirement R\n  always a.x < 2\n").evaluate(tmp_path)
