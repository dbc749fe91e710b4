"""Recordings held in memory, and longer ones that are read again."""

import os

import pytest

from rvmon.cli import run, why
from rvmon.recordings import held_recording, places
from rvmon.recordings.held_recording import HeldRecording, held
from rvmon.report import attempt_panels
from rvmon.trace.sample import Sample

SAMPLES = [Sample(t, {"x": float(t)}) for t in range(10)]


@pytest.mark.parametrize("most", [40, 99, 100, 1000])
def test_it_is_the_same_each_time_however_much_is_held(monkeypatch, most):
    monkeypatch.setattr(held_recording, "MOST_HELD", most)
    readings = []

    def read():
        readings.append(len(readings))
        return iter(SAMPLES)

    recording = HeldRecording(read(), (), read)
    assert recording
    assert recording[0] is SAMPLES[0]
    assert readings == [0]
    next(recording.pieces())  # an iteration that is abandoned
    for _ in range(3):
        assert [*recording] == SAMPLES
        assert recording[3] is SAMPLES[3]
        assert len(recording) == 10
    assert (len(readings) > 1) == (most < 100)
    assert [recording.is_longer_than(rows) for rows in (most // 10, 0)] == [most < 100, True]


def test_without_a_way_to_read_it_again_all_of_it_is_held(monkeypatch):
    monkeypatch.setattr(held_recording, "MOST_HELD", 1)
    recording = held(iter(SAMPLES))
    assert [*recording] == [*recording] == SAMPLES
    assert held(recording) is recording
    assert not held([])


SPEC = """
signal gap : real
signal near : bool
requirement R
  upon rise(near)
  then within 2 s gap > 3
"""


def test_pages_and_reasons_are_those_of_a_recording_that_is_held(monkeypatch, tmp_path, says):
    (tmp_path / "a.rv").write_text(SPEC)
    rows = "".join(f"{t},{t * 7 % 5 * 0.9},{int(t % 11 in (2, 3, 7))}\n" for t in range(200))
    (tmp_path / "a.csv").write_text("t,gap,near\n" + rows)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(places, "BLOCK", 256)
    monkeypatch.setattr(attempt_panels, "MOST_DISSECTED", 20)  # pages show no parts of more rows
    words = [1, "run", "a.rv", "a.csv", "--report", "pages"], [0, "why", "a.rv", "a.csv", "R"]
    found = []
    for most in (1_000_000, 50):
        for module in (held_recording, why):
            monkeypatch.setattr(module, "MOST_HELD", most)
        said = [says(code, *one).out for code, *one in words]
        found.append((said, (tmp_path / "pages" / "a.html").read_text()))
    assert found[0] == found[1]
    assert "gap" in found[0][1]


def appended(path):
    path.write_text(path.read_text() + "9,1,0\n")


def replaced(path):
    """Replaced by another file of the same size and time."""
    other, before = path.with_name("other.csv"), path.stat()
    other.write_text(path.read_text().replace("1.5", "2.5"))
    os.utime(other, ns=(before.st_atime_ns, before.st_mtime_ns))
    os.replace(other, path)


@pytest.mark.parametrize("change", [None, appended, replaced])
@pytest.mark.parametrize(
    ("module", "step", "words"),
    [
        (run, "write_files", ["run", "a.rv", "a.csv", "--report", "pages"]),
        (why, "dissect", ["why", "a.rv", "a.csv", "R"]),
    ],
)
def test_a_recording_that_is_rewritten_between_two_readings_is_reported(
    module, step, words, change, monkeypatch, tmp_path, says
):
    real = getattr(module, step)

    def after_a_change(*arguments):
        if change is not None:
            change(tmp_path / "a.csv")
        return real(*arguments)

    monkeypatch.setattr(module, step, after_a_change)
    (tmp_path / "a.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("t,gap,near\n0,1.5,0\n1,1,1\n5,1,1\n")
    monkeypatch.chdir(tmp_path)
    told = says(int(words[0] == "run"), *words)
    assert ("a.csv changed while it was read" in told.err) == (change is not None)
