"""Files read in pieces of columns: the same report as sample by sample."""

import random
from functools import partial
from pathlib import Path

import pytest
from tests.rvmon.recordings.csv_reference import samples_of_csv

import rvmon
from rvmon.recordings import places
from rvmon.recordings.batch import Batch
from rvmon.recordings.source import Source

SPEC = """
spec watch "A base"
time {time}
signal p : bool
signal speed : real  {stale}
signal count : int
event stop
requirement R1 "a"
  upon stop
  then within 1 s speed < 0.2
requirement R2 "b"
  whenever p and once[100 ms, 900 ms] count > 2
  then within 700 ms speed * 2 + 1 < 1.5
requirement R3 "c"
  always (count >= 3 -> within 1 s (count < 1 or stop))
"""


def csv_text(seed: int, rows: int = 1000) -> str:
    rng = random.Random(seed)
    t, speed, p, count = 0, 0.3, False, 0
    lines = ["t,ignored,speed,p,stop,count"]
    for _ in range(rows):
        t += rng.choice([1, 50_000_000, 49_999_999, 600_000_000])
        speed += rng.choice([0, 0, 0.01, -0.01])
        p ^= rng.random() < 0.05
        count = rng.randrange(5) if rng.random() < 0.1 else count
        stop = int(rng.random() < 0.02)
        lines.append(f"{t // 10**9}.{t % 10**9:09d},7,{speed:.3f},{p:d},{stop},{count}")
    return "\n".join(lines) + "\n"


def by_rows(spec: rvmon.Spec, path: Path, end: int | None = None) -> rvmon.Report:
    """The report of the slow way, on the samples up to an instant."""
    monitor = spec.monitor(sources=spec.recording(path).names)
    for sample in samples_of_csv(spec, path):
        if end is None or sample.t <= end:
            monitor.step_ns(sample.t, sample.values)
    return monitor.finish_ns(end)


def in_columns(spec: rvmon.Spec, path: Path, end: int | None = None) -> rvmon.Report:
    """The report of a file of which there are pieces in columns."""
    pieces = list(spec.recording(path).pieces())
    assert any(isinstance(piece, Batch) for piece in pieces)
    return spec.judge(Source(spec.recording(path), end, is_cut=True))


@pytest.fixture
def cut_into(monkeypatch):
    """Has files read in pieces of so many bytes."""
    return partial(monkeypatch.setattr, places, "BLOCK")


@pytest.mark.law
@pytest.mark.parametrize(
    ("time", "stale"),
    [("held", ""), ("held", "stale after 300 ms"), ("sampled", ""), ("sampled every 20 ms", "")],
)
@pytest.mark.parametrize("end", [0.1, 31.4, 9999.0])
def test_columns_say_what_rows_say(end, time, stale, tmp_path, cut_into):
    cut_into(1999)
    (tmp_path / "a.csv").write_text(csv_text(3).replace("\n", "\r\n"))
    spec = rvmon.loads(SPEC.format(time=time, stale=stale))
    report = in_columns(spec, tmp_path / "a.csv", round(end * 1e9))
    assert report == by_rows(spec, tmp_path / "a.csv", round(end * 1e9))


@pytest.mark.slow
@pytest.mark.parametrize("text", ["t,p,x\n1,1,{}\n", "t,p,{}\n1,1,1\n"])
def test_a_cell_that_rows_refuse_is_refused(text, tmp_path, cut_into):
    """A cell is as long as it may be, or one longer: judged both ways, or refused with its line."""
    cut_into(1 << 17)
    spec = rvmon.loads(SPEC.format(time="held", stale=""))
    (tmp_path / "a.csv").write_text(text.format("a" * 131072))
    found = spec.evaluate(tmp_path / "a.csv", allow_missing=True)
    assert found == by_rows(spec, tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text(text.format("a" * 131073))
    with pytest.raises(rvmon.TraceError, match=r"line \d: a cell has more than 131,072 characters"):
        spec.evaluate(tmp_path / "a.csv", allow_missing=True)
