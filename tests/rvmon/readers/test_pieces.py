"""Files read in pieces of columns: the same report as sample by sample."""

import random
from functools import partial
from pathlib import Path

import pytest
from tests.rvmon.readers.csv_reference import samples_of_csv

import rvmon
from rvmon.readers import parquet as parquet_module
from rvmon.readers import places
from rvmon.readers.batch import Batch
from rvmon.readers.source import Source

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
    """A plain file: every cell is filled."""
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
    opened = spec.recording(path)
    monitor = spec.monitor(sources=opened.names)
    for sample in samples_of_csv(spec, path) if path.suffix == ".csv" else opened:
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
    """Up to an instant: verdicts, records, reasons and health, wherever a block ends."""
    cut_into(1999)
    (tmp_path / "a.csv").write_text(csv_text(3).replace("\n", "\r\n"))
    spec = rvmon.loads(SPEC.format(time=time, stale=stale))
    report = in_columns(spec, tmp_path / "a.csv", round(end * 1e9))
    assert report == by_rows(spec, tmp_path / "a.csv", round(end * 1e9))


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled every 20 ms", "sampled"])
def test_gaps_are_filled_where_only_values_matter(time, tmp_path, cut_into):
    """Empty cells: signals hold, events do not occur; the same as row by row."""
    cut_into(997)
    rng = random.Random(5)
    first, second, *rest = csv_text(4).splitlines()
    rest = [
        ",".join(c if n == 0 or rng.random() < 0.3 else "" for n, c in enumerate(row.split(",")))
        for row in rest
    ]
    (tmp_path / "a.csv").write_text("\n".join([first, second, *rest]) + "\n")
    spec = rvmon.loads(SPEC.format(time=time, stale=""))
    report = in_columns(spec, tmp_path / "a.csv")
    assert report == by_rows(spec, tmp_path / "a.csv")
    assert {"P", "F"} <= {attempt.verdict for attempt in report.attempts}
    for other in (
        SPEC.format(time=time, stale="stale after 300 ms"),
        SPEC.format(time=time, stale="") + "requirement R4\n  always not updated(stop)\n",
    ):
        spec = rvmon.loads(other)
        assert spec.evaluate(tmp_path / "a.csv") == by_rows(spec, tmp_path / "a.csv")


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled every 20 ms", "sampled"])
def test_parquet_says_what_csv_says(time, tmp_path, monkeypatch):
    """The same recording as Parquet, whole and with gaps."""
    monkeypatch.setattr(parquet_module, "ROWS", 333)
    import pyarrow
    from pyarrow import csv, parquet

    (tmp_path / "a.csv").write_text(csv_text(2))
    types = {"p": pyarrow.bool_(), "stop": pyarrow.bool_(), "t": pyarrow.float64()}
    table = csv.read_csv(tmp_path / "a.csv", convert_options=csv.ConvertOptions(column_types=types))
    parquet.write_table(table, tmp_path / "a.parquet", row_group_size=700)
    spec = rvmon.loads(SPEC.format(time=time, stale=""))
    expected = by_rows(spec, tmp_path / "a.csv")
    assert spec.evaluate(tmp_path / "a.parquet") == expected
    assert by_rows(spec, tmp_path / "a.parquet") == expected

    rng = random.Random(6)
    for first in (True, False):
        gaps = table
        for place, name in enumerate(table.column_names):
            if name not in ("t", "ignored"):
                cells = table.column(name).to_pylist()
                cells[1:] = [cell if rng.random() < 0.2 else None for cell in cells[1:]]
                cells[0] = cells[0] if first else None
                kept = pyarrow.array(cells, table.schema.field(name).type)
                gaps = gaps.set_column(place, name, kept)
        parquet.write_table(gaps, tmp_path / "gaps.parquet")
        expected = by_rows(spec, tmp_path / "gaps.parquet")
        assert spec.evaluate(tmp_path / "gaps.parquet") == expected
        assert {"P", "F"} <= {attempt.verdict for attempt in expected.attempts}


def test_what_is_no_parquet_file_is_refused_with_its_name(tmp_path):
    """The message names the file and what is wrong with it."""
    (tmp_path / "a.parquet").write_text("t,p\n")
    spec = rvmon.loads(SPEC.format(time="held", stale=""))
    with pytest.raises(rvmon.TraceError, match=r"a\.parquet: not a Parquet file"):
        spec.evaluate(tmp_path / "a.parquet")


CELLS = {
    "t,p\n0,{}\n": "1 0 true FALSE yes 1.0 -0",
    "t,count\n0,{}\n": "3 -7 +12 007 0x1F 1.0 9223372036854775808 nan 1_000",
    "t,speed\n0,{}\n1,0.1\n": "0.1 0.30000000000000004 1e-3 +1.5 -0 .5 5. . inf -inf 1e400 "
    "1e-400 nan nan(1) 1_0 1e",
    "t,p\n{},1\n": "1 1.5 1e0 1.000000001 1.0000000001 +1 nan inf 1_0 4611686018.427387904",
    "t_ns,p\n{},1\n": "1 +1 007 0x1F 1.0 1e3 4611686018427387903 4611686018427387904",
}
"""Files with a cell to be filled in, and what is."""


def told(judge, spec: rvmon.Spec, path: Path) -> rvmon.Report | str:
    """What is said of a file, or of its fault."""
    try:
        return judge(spec, path)
    except rvmon.TraceError as error:
        return str(error)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text", [text.format(cell) for text, cells in CELLS.items() for cell in cells.split()]
)
def test_a_cell_is_read_as_in_rows(text, tmp_path):
    """Whatever is taken for a number, or is not: report and errors are those of rows."""
    path = tmp_path / "a.csv"
    path.write_text(text)
    spec = rvmon.loads(SPEC.format(time="held", stale=""))
    expected = told(by_rows, spec, path)
    assert told(lambda spec, path: spec.evaluate(path, allow_missing=True), spec, path) == expected


@pytest.mark.parametrize("text", ["t,p,x\n1,1,{}\n", "t,p,{}\n1,1,1\n"])
def test_a_cell_that_rows_refuse_is_refused(text, tmp_path, cut_into):
    """A cell is as long as it may be, or one longer: judged both ways, or refused with its line."""
    cut_into(1 << 17)
    spec = rvmon.loads(SPEC.format(time="held", stale=""))
    (tmp_path / "a.csv").write_text(text.format("a" * 131072))
    found = spec.evaluate(tmp_path / "a.csv", allow_missing=True)
    assert found == by_rows(spec, tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text(text.format("a" * 131073))
    with pytest.raises(rvmon.TraceError, match=r"line \d: .*field larger than field limit"):
        spec.evaluate(tmp_path / "a.csv", allow_missing=True)
