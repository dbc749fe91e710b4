"""`rvmon clip` as a person uses it."""

import os
import threading
from pathlib import Path

import pytest

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


def clip(*words):
    return main(["clip", "base.rv", "a.csv", *words])


def test_rows_are_copied_as_they_stand_and_values_are_carried(base, capsys):
    assert clip("R1#1", "--before", "1s", "--after", "1 s", "-o", "b.csv") == 0
    rows = (base / "b.csv").read_text().splitlines()
    assert rows == [ROWS[0], "14,0.7,False,,".lower(), *ROWS[4:7]]
    assert capsys.readouterr().out.splitlines() == [
        "b.csv: 3 entries of a.csv, 15 s to 17 s",
        "carried to its start: `speed`, `ready`",
        "R1#1 is R1#1 in b.csv: F, decided at 16.000000001 s, as in a.csv",
    ]


def test_quoted_ends_of_lines_stay(base):
    assert clip("--from", "11", "--to", "16", "-o", "b.csv") == 0
    assert '12,0.7,,,"two\nlines"\n' in (base / "b.csv").read_text()


def test_a_last_line_without_its_end_has_none_in_the_piece(base):
    """What it said last is not known there, either."""
    (base / "a.csv").write_text("t,go,ready,speed\n0,,0,0.5\n5,1,1,0.6\n6,,,0.7")
    assert clip("R2", "-o", "b.csv") == 0
    assert (base / "b.csv").read_text().endswith("\n6,,,0.7")
    assert rvmon.load("base.rv").evaluate("b.csv").verdicts["R2"] == "I"


def test_an_episode_is_cut_around_what_failed(base, capsys):
    """It may have begun hours before; in the piece it begins with it."""
    assert clip("R2", "--before", "0", "--after", "0", "-o", "b.csv") == 0
    assert (base / "b.csv").read_text().splitlines() == [ROWS[0], ROWS[6]]
    assert "R2#1 is R2#1 in b.csv: F, decided at 17 s" in capsys.readouterr().out


def test_what_a_past_operator_remembers_needs_more_before(base, capsys):
    assert clip("R3#1", "--before", "2s", "-o", "b.csv") == 1
    told = capsys.readouterr().err
    assert "R3#1 is P in a.csv, but not in b.csv, where R3 is F" in told
    assert "a longer --before" in told
    assert clip("R3#1", "--before", "5s", "-o", "b.csv") == 0


def test_what_ends_too_early_is_said(base, capsys):
    """Time decides a deadline only if there is a row behind it: by itself, that is taken along."""
    assert clip("R1#1", "--to", "16.2", "-o", "b.csv") == 1
    assert "it was decided at 16.000000001 s: a later --to" in capsys.readouterr().err
    assert clip("R1#1", "--after", "100ms", "-o", "b.csv") == 0
    assert (base / "b.csv").read_text().splitlines()[-1] == ROWS[5]


def test_a_recording_that_breaks_off_can_be_cut(base, capsys):
    (base / "a.csv").write_text("\n".join([*ROWS, "broken"]))
    assert clip("R1#1", "--after", "2s", "-o", "b.csv") == 0
    assert "attempts decided before that count" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["b.csv", "b.jsonl", "b.parquet"])
def test_what_goes_back_behind_the_end_is_no_part_of_a_piece(base, name):
    """The good begin of a recording whose clock jumped can be saved."""
    times = [0, 1, 2, 3, 1, 2, 7]
    if name == "b.csv":
        (base / "in.csv").write_text("t,speed\n" + "".join(f"{t},1\n" for t in times))
    elif name == "b.jsonl":
        (base / "in.jsonl").write_text("".join(f'{{"t": {t}, "speed": 1}}\n' for t in times))
    else:
        pyarrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        table = pyarrow.table({"t": times, "speed": [1.0] * len(times)})
        parquet.write_table(table, base / "in.parquet")
    words = ["clip", "base.rv", name.replace("b", "in", 1), "--from", "1", "--to", "2", "-o", name]
    assert main(words) == 0
    names = rvmon.load("base.rv").evaluate(name, allow_missing=True)
    assert names.end == 2 * 10**9


def test_what_is_broken_behind_the_end_of_a_piece_does_not_matter(base):
    good = [f'{{"t": {t}, "speed": 1}}\n' for t in range(4)]
    (base / "a.jsonl").write_text("".join(good) + '{"t": "x"}\n')
    assert main(["clip", "base.rv", "a.jsonl", "--from", "1", "--to", "2", "-o", "b.jsonl"]) == 0
    assert (base / "b.jsonl").read_text() == "".join(good[1:3])


def test_lines_whose_names_are_mapped_can_be_cut(base):
    lines = [f'{{"t": {t}, "v": 1}}\n' for t in range(3)]
    (base / "a.jsonl").write_text("".join(lines))
    words = ["--map", "speed=v", "--from", "1", "-o", "b.jsonl"]
    assert main(["clip", "base.rv", "a.jsonl", *words]) == 0
    assert (base / "b.jsonl").read_text() == '{"t": 1, "v": 1}\n' + lines[2]


def test_a_value_is_carried_into_a_column_with_its_unit(base):
    """Units stand behind names, that of the time as well."""
    (base / "a.csv").write_text("t [ms],speed [m/s],ready,go\n0,0.5,1,\n9000,,0,\n12000,,1,\n")
    assert clip("--from", "4", "--to", "9", "-o", "b.csv") == 0
    assert (base / "b.csv").read_text().splitlines()[1:] == ["4000,0.5,true,", "9000,,0,"]


def test_what_is_no_text_is_said(base, capsys, monkeypatch):
    """Also where it is found while rows are copied."""
    monkeypatch.setattr(places, "BLOCK", 64)
    rows = "".join(f"{t},1,1,\n" for t in range(100)) + "100,1,1,\xe9\n"
    (base / "a.csv").write_bytes(f"t,speed,ready,note\n{rows}".encode("latin1"))
    assert clip("--to", "5", "-o", "b.csv") == 2
    assert "error: a.csv: not UTF-8 text" in capsys.readouterr().err


def test_columns_with_dictionaries_are_cut_with_their_stamps(base):
    """Of them the rows of a group come together, of others more."""
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
def test_a_pipe_is_refused_and_shown_without_its_values(base, capsys):
    """It is gone when it was read; to wait for another one would take for ever."""
    os.mkfifo("a.jsonl")
    assert main(["clip", "base.rv", "a.jsonl", "R2", "-o", "b.jsonl"]) == 2
    assert "a.jsonl can be read once only: save the recording first" in capsys.readouterr().err
    line = b'{"t": 0, "speed": 2}\n{"t": 1, "speed": 2}\n'
    writer = threading.Thread(target=Path("a.jsonl").write_bytes, args=(line,))
    writer.start()
    assert main(["run", "base.rv", "a.jsonl", "--report", "page"]) == 1
    writer.join()
    assert "R2-1" in next(base.glob("page*/a.html")).read_text()


def test_late_rows_are_found(base, capsys):
    (base / "base.rv").write_text(SPEC.replace("spec base\n", "spec base\nmax delay 5 s\n"))
    (base / "a.csv").write_text(
        "t,speed,ready,go\n0,0.5,false,\n9,0.4,,\n8,0.3,,\n12,,,\n10,,,1\n20,,,\n"
    )
    assert clip("R1#1", "--before", "0.5s", "--after", "2s", "-o", "b.csv") == 0
    assert (base / "b.csv").read_text() == "t,speed,ready,go\n9.5,0.4,false,\n12,,,\n10,,,1\n"


def test_a_bag_is_not_replaced(base, says):
    """It is a folder, which may hold other things."""
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
