"""`rvmon clip`: which rows a piece has, and what is reported."""

import os
import shlex
import threading
from pathlib import Path

import pytest
from tests.tools.each import each

import rvmon
from rvmon.cli import main
from rvmon.recordings import places

SPEC = """
spec base
signal speed : real stale after 5 s
signal ready : bool
event go
requirement R1
  upon go
  then within 1 s ready
requirement R2
  always speed <= 1
requirement R3
  upon go
  then O[0, 6 s] (speed > 0.8)
"""
ROWS = [
    "t,speed,ready,go,note",
    '0,0.5,false,,"a, b"',
    "10,0.9,,,",
    '12,0.7,,,"two\nlines"',
    "15,,,true,",
    "16.5,,,,x",
    "17,2,true,,",
    "30,0.5,,,",
]


@pytest.fixture
def base(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("\n".join(ROWS))
    return tmp_path


@pytest.fixture
def clip(base, says):
    """Cut b.csv out of a.csv with an expected exit code, and return what is printed."""

    def run(code, words):
        return says(code, "clip", "base.rv", "a.csv", *shlex.split(words), "-o", "b.csv")

    return run


UNITS = ["t [ms],speed [m/s],ready,go", "0,0.5,1,", "9000,,0,", "12000,,1,"]
UNENDED = ["t,go,ready,speed", "0,,0,0.5", "5,1,1,0.6", "6,,,0.7"]


@each(
    ("rows", "words", "piece"),
    [
        # Values are carried to the start of the piece, into the units of their columns.
        (ROWS, "R1#1 --before 1s --after '1 s'", [ROWS[0], "14,0.7,false,,", *ROWS[4:7]]),
        (UNITS, "--from 4 --to 9", [UNITS[0], "4000,0.5,true,", UNITS[2]]),
        # Line breaks in quotes stay, and so does the lack of one after the last line.
        (ROWS, "--from 11 --to 16", [ROWS[0], "11,0.9,false,,", *ROWS[3:5]]),
        (UNENDED, "--from 5", [UNENDED[0], *UNENDED[2:]]),
        # An attempt of `always` is cut around its failure, however long ago it started.
        (ROWS, "R2 --before 0 --after 0", [ROWS[0], ROWS[6]]),
        # A row after the deadline is taken along, as only a later row decides it.
        (ROWS, "R1#1 --after 100ms", [ROWS[0], "5,0.5,false,,", *ROWS[2:6]]),
    ],
)
def test_a_piece_holds_the_rows_of_its_stretch(base, clip, rows, words, piece):
    (base / "a.csv").write_text("\n".join(rows))
    clip(0, words)
    end = "" if piece[-1] == rows[-1] else "\n"
    assert (base / "b.csv").read_text() == "\n".join(piece) + end


def test_the_piece_its_carried_values_and_its_verdict_are_reported(base, clip):
    assert clip(0, "R1#1 --before 1s --after '1 s'").out.splitlines() == [
        "b.csv: 3 entries of a.csv, 15 s to 17 s",
        "carried to its start: `speed`, `ready`",
        "R1#1 is R1#1 in b.csv: F, decided at 16.000000001 s, as in a.csv",
    ]


def test_an_unfinished_last_line_leaves_the_verdict_open_in_the_piece(base, clip):
    (base / "a.csv").write_text("\n".join(UNENDED))
    clip(0, "R2")
    assert rvmon.load("base.rv").evaluate("b.csv").verdicts["R2"] == "I"


def test_a_changed_verdict_names_the_option_that_keeps_it(clip):
    told = clip(1, "R3#1 --before 2s").err
    assert "R3#1 is P in a.csv, but not in b.csv, where R3 is F" in told
    assert "a longer --before" in told
    clip(0, "R3#1 --before 5s")
    told = clip(1, "R1#1 --to 16.2").err
    assert "it was decided at 16.000000001 s: a later --to" in told


def test_a_recording_that_breaks_off_can_be_clipped(base, clip):
    (base / "a.csv").write_text("\n".join([*ROWS, "broken"]))
    assert "attempts decided before that count" in clip(0, "R1#1 --after 2s").err


@pytest.mark.parametrize("form", ["csv", "jsonl", "parquet"])
def test_rows_that_go_back_in_time_after_the_end_are_left_out(base, form):
    times = [0, 1, 2, 3, 1, 2, 7]
    if form == "csv":
        (base / "in.csv").write_text("t,speed\n" + "".join(f"{t},1\n" for t in times))
    elif form == "jsonl":
        (base / "in.jsonl").write_text("".join(f'{{"t": {t}, "speed": 1}}\n' for t in times))
    else:
        pyarrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        table = pyarrow.table({"t": times, "speed": [1.0] * len(times)})
        parquet.write_table(table, base / "in.parquet")
    words = ["clip", "base.rv", f"in.{form}", "--from", "1", "--to", "2", "-o", f"out.{form}"]
    assert main(words) == 0
    report = rvmon.load("base.rv").evaluate(f"out.{form}", allow_missing=True)
    assert report.end == 2 * 10**9


def test_faults_after_the_end_of_a_piece_do_not_matter(base):
    good = [f'{{"t": {t}, "speed": 1}}\n' for t in range(4)]
    (base / "a.jsonl").write_text("".join(good) + '{"t": "x"}\n')
    assert main(["clip", "base.rv", "a.jsonl", "--from", "1", "--to", "2", "-o", "b.jsonl"]) == 0
    assert (base / "b.jsonl").read_text() == "".join(good[1:3])


def test_lines_with_mapped_names_can_be_clipped(base):
    lines = [f'{{"t": {t}, "v": 1}}\n' for t in range(3)]
    (base / "a.jsonl").write_text("".join(lines))
    words = ["--map", "speed=v", "--from", "1", "-o", "b.jsonl"]
    assert main(["clip", "base.rv", "a.jsonl", *words]) == 0
    assert (base / "b.jsonl").read_text() == "".join(lines[1:])


def test_bytes_that_are_no_text_are_reported_while_rows_are_copied(base, clip, monkeypatch):
    monkeypatch.setattr(places, "BLOCK", 64)
    rows = "".join(f"{t},1,1,\n" for t in range(100)) + "100,1,1,\xe9\n"
    (base / "a.csv").write_bytes(f"t,speed,ready,note\n{rows}".encode("latin1"))
    assert "error: a.csv: not UTF-8 text" in clip(2, "--to 5").err


def test_dictionary_columns_keep_their_stamps(base):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    notes = pyarrow.array(["a", "b", "c", "d"] * 25).dictionary_encode()
    table = pyarrow.table({"t": [*range(100)], "speed": [0.5] * 100, "note": notes})
    parquet.write_table(table, "in.parquet", row_group_size=7)
    words = ["--from", "10", "--to", "60", "-o", "b.parquet"]
    assert main(["clip", "base.rv", "in.parquet", *words]) == 0
    piece = parquet.read_table("b.parquet").to_pydict()
    assert piece["t"] == [*range(10, 61)]
    assert piece["note"][1:] == table["note"].to_pylist()[11:61]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_a_pipe_is_refused_by_clip_and_reported_by_run(base, says):
    """A pipe is empty once read, and waiting for another writer would never end."""
    os.mkfifo("a.jsonl")
    told = says(2, "clip", "base.rv", "a.jsonl", "R2", "-o", "b.jsonl").err
    assert "a.jsonl can be read once only: save the recording first" in told
    line = b'{"t": 0, "speed": 2}\n{"t": 1, "speed": 2}\n'
    writer = threading.Thread(target=Path("a.jsonl").write_bytes, args=(line,))
    writer.start()
    assert main(["run", "base.rv", "a.jsonl", "--report", "page"]) == 1
    writer.join()
    assert "R2-1" in next(base.glob("page*/a.html")).read_text()


def test_late_rows_are_in_the_piece_or_carried_to_its_start(base, clip):
    (base / "base.rv").write_text(SPEC.replace("spec base\n", "spec base\nmax delay 5 s\n"))
    (base / "a.csv").write_text(
        "t,speed,ready,go\n0,0.5,false,\n9,0.4,,\n8,0.3,,\n12,,,\n9.2,0.6,,\n10,,,1\n20,,,\n"
    )
    clip(0, "R1#1 --before 0.5s --after 2s")
    assert (base / "b.csv").read_text() == "t,speed,ready,go\n9.5,0.6,false,\n12,,,\n10,,,1\n"


def test_a_bag_is_not_replaced(base, says):
    """A bag is a folder, which may hold other files."""
    pytest.importorskip("rosbags")
    from tests.tools.bags import START, write_ros2

    write_ros2(base / "bag", [("/speed", START, {"data": 2.0})], "sqlite3")
    (base / "b").mkdir()
    words = ["clip", "base.rv", "bag", "R2", "-o", "b", "--allow-missing"]
    assert "cannot write b: it exists already, and a bag needs a new folder" in says(2, *words).err


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "second"), [("datetime64[ms]", 1000), ("timedelta64[s]", 1)])
def test_a_column_of_dates_or_durations_is_clipped_as_it_is_judged(base, says, kind, second):
    pyarrow = pytest.importorskip("pyarrow")
    numpy = pytest.importorskip("numpy")
    parquet = pytest.importorskip("pyarrow.parquet")
    speed = numpy.where(numpy.arange(100) < 50, 0.5, 2.0)
    columns = {"t": (numpy.arange(100) * second).astype(kind), "speed": speed}
    parquet.write_table(pyarrow.table(columns), "a.parquet")
    (base / "v.rv").write_text("spec s\nsignal speed : real\nrequirement R1\n  always speed <= 1")
    assert "40 s to 55 s" in says(0, "clip", "v.rv", "a.parquet", "R1#1", "--out", "b.parquet").out
    piece = parquet.read_table("b.parquet")
    assert piece.schema == parquet.read_table("a.parquet").schema
    assert main(["run", "v.rv", "b.parquet", "--quiet"]) == 1
