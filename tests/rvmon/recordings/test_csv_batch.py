"""CSV in blocks gives the samples of its rows, whatever is odd and wherever a block ends."""

import csv
import random
import struct
from pathlib import Path

import numpy as np
import pytest
from tests.tools.each import each

import rvmon
from rvmon.recordings import csv_batch, places
from rvmon.recordings.batch import Batch
from rvmon.recordings.csv_rows import csv_samples, read_layout, split_lines
from rvmon.recordings.csv_text import native_csv
from rvmon.recordings.rows import Rows

SPEC = rvmon.loads("""
spec all "Each kind of value"
signal p : bool
signal speed : real
signal count : int
signal mode : {idle, pick, place}
event stop(id: int, part: {arm, hand})
requirement R1 "a"
  always (count < 5)
""")
HEADER = ["t", "p", "speed", "count", "mode", "stop", "stop.id", "stop.part", "note"]
ODD = ["", " ", "nan", "NaN", "-1", "7.0", "1e3", "x", '"', 'a"b', "\xa0", "\xa05", "é", "\x1f3"]
ENDS = ["\n"] * 6 + ["\r\n", "\r", "\n\n", "\n \n", "\r\n\r\n"]


def quoted(rng: random.Random, cell: str) -> str:
    """A cell as it may be written."""
    if "," in cell or "\n" in cell or "\r" in cell or rng.random() < 0.1:
        return '"' + cell.replace('"', '""') + '"'
    return cell


def number(rng: random.Random) -> str:
    """A number as programs write it: short, exact, or with superfluous digits."""
    exact = struct.unpack("d", rng.randbytes(8))[0]
    return rng.choice(
        [
            f"{rng.uniform(-9, 9):.3f}",
            f"{rng.uniform(-1, 1) * 10 ** rng.randrange(9):.{rng.randrange(9)}f}",
            repr(rng.random()),
            repr(rng.uniform(-1e6, 1e6)),
            repr(exact),
            f"{rng.random():.25f}",
            f"{rng.randrange(10**19)}e-{rng.randrange(25)}",
            f".{rng.randrange(10**18):018d}",
        ]
    )


def csv_text(rng: random.Random, oddness: float) -> str:
    rows, t = [",".join(HEADER)], 0
    for _ in range(rng.randrange(40)):
        t += rng.choice([0, 1, 50_000_000, 600_000_000])
        cells = [
            f"{t // 10**9}.{t % 10**9:09d}",
            rng.choice(["1", "0", "true", "FALSE", ""]),
            number(rng),
            str(rng.choice([0, 3, -7, 2**63 - 1, rng.randrange(10**9)])),
            rng.choice(["idle", "pick", "place", "", "lost"]),
            rng.choice(["1", "0", ""]),
            rng.choice(["1", "", ""]),
            rng.choice(["arm", "hand", 'say "a"', "b,c", "d\ne", "f\r\ng", ""]),
            rng.choice(["anything", "h\ri", "", '"']),
        ]
        for place in range(len(cells)):
            if rng.random() < oddness:
                cells[place] = rng.choice(ODD)
        if rng.random() < oddness / 4:
            cells.append("more") if rng.random() < 0.5 else cells.pop()
        rows.append(",".join(quoted(rng, cell) for cell in cells))
    return "".join(row + rng.choice(ENDS) for row in rows)[: rng.choice([-1, None, None])]


def read(samples) -> list[tuple[int, str]]:
    """The samples of a recording, and its error, if any, after the samples before it."""
    made = []
    try:
        made += ((one.t, repr(sorted(one.values.items()))) for one in samples)
    except rvmon.TraceError as error:
        made.append((-1, str(error)))
    return made


def samples_of_csv(spec: rvmon.Spec, path: Path):
    """The reference reads a file row by row; errors have the file's name."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as text:
            rows = split_lines(text)
            layout = read_layout(next(rows)[1], spec.schema)
            made = Rows(spec.schema, "line", ordered=True)
            yield from made.samples(csv_samples(rows, layout))
            if not made.count:
                raise rvmon.TraceError("holds no sample")
    except rvmon.TraceError as error:
        raise type(error)(f"{path}: {error}") from None


def of_pieces(path: Path):
    """The samples of a file read in columns, without merging equal stamps."""
    opened = SPEC.recording(path)
    for piece in opened.pieces():
        if isinstance(piece, Batch):
            yield from opened.rows.samples(
                (0, one.t, one.values) for one in piece.rows(0, len(piece.times))
            )
        else:
            yield piece


@pytest.mark.law
def test_columns_say_what_rows_say(tmp_path, monkeypatch):
    for seed in range(100):
        rng = random.Random(seed)
        (tmp_path / "a.csv").write_text(csv_text(rng, rng.choice([0, 0.01, 0.1])), newline="")
        expected = read(samples_of_csv(SPEC, tmp_path / "a.csv"))
        monkeypatch.setattr(places, "BLOCK", rng.choice([1, 7, 100, 999, 1 << 20]))
        monkeypatch.setattr(csv_batch, "_ODD", 1)
        monkeypatch.setattr(csv_batch, "_LABELS", 1)
        assert read(of_pieces(tmp_path / "a.csv")) == expected
        assert read(SPEC.recording(tmp_path / "a.csv")) == expected


CELLS = {
    "t,p\n0,{}\n": "1 0 true FALSE yes 1.0 -0",
    "t,count\n0,{}\n": "3 -7 +12 007 0x1F 1.0 9223372036854775808 nan 1_000",
    "t,speed\n0,{}\n1,0.1\n": "0.1 0.30000000000000004 1e-3 +1.5 -0 .5 5. . inf -inf 1e400 "
    "1e-400 nan nan(1) 1_0 1e",
    "t,p\n{},1\n": "1 1.5 1e0 1.000000001 1.0000000001 +1 nan inf 1_0 4611686018.427387904",
    "t_ns,p\n{},1\n": "1 +1 007 0x1F 1.0 1e3 4611686018427387903 4611686018427387904",
    "t_ns,p\n-9,1\n{},1\n900,0\n": "5 +5 -5 05 5. +5. 5.0 5e0 5.e0 5E3",
}
"""Files with a cell to be filled in, and what is."""


@each("text", [text.format(cell) for text, cells in CELLS.items() for cell in cells.split()])
def test_a_cell_is_read_as_in_rows(text, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(text)
    expected = read(samples_of_csv(SPEC, path))
    assert read(SPEC.recording(path)) == expected
    assert read(of_pieces(path)) == expected


@pytest.mark.slow
@pytest.mark.parametrize("text", ["t,p,x\n1,1,{}\n", "t,p,{}\n1,1,1\n"])
@pytest.mark.parametrize(("length", "told"), [(131072, ""), (131073, "more than 131,072 char")])
def test_a_cell_is_as_long_as_in_rows(text, length, told, tmp_path, monkeypatch):
    monkeypatch.setattr(places, "BLOCK", 1 << 17)
    (tmp_path / "a.csv").write_text(text.format("a" * length))
    found = read(of_pieces(tmp_path / "a.csv"))
    assert found == read(samples_of_csv(SPEC, tmp_path / "a.csv"))
    assert told in found[0][1]
    assert found[0][0] == (-1 if told else 10**9)


@pytest.mark.slow
def test_cells_of_any_characters_are_read_as_in_rows(tmp_path):
    rng, path = random.Random(3), tmp_path / "a.csv"
    for _ in range(1000):
        name = rng.choice(["p", "speed", "count", "t_ns", "t"])
        letters = rng.choice(["0123456789", "0123456789.", "0123456789.-", '01.e-+ é"\r'])
        cell = "".join(rng.choices(letters, k=rng.choice([1, 2, 7, 8, 9, 15, 16, 17, 20])))
        cell = rng.choice(["", "", "-", "-0.", "0."]) + cell
        cell = cell.rstrip(".") if name == "t_ns" else cell
        stamp = name if name.startswith("t") else "t"
        row = cell if name == stamp else f"1000000,{cell}"
        header = stamp if name == stamp else f"{stamp},{name}"
        first = "-123456789,1" if name != stamp else "-4611686018"
        text = f"{header},note\n{first},{'.' * 16}\n{row},0\n{row},-1.5\n"
        path.write_text(text, encoding="utf-8", newline="")
        assert read(SPEC.recording(path)) == read(samples_of_csv(SPEC, path)), text


@pytest.mark.slow
def test_numbers_are_the_nearest(tmp_path):
    rng = random.Random(1)
    texts = [number(rng) for _ in range(20_000)]
    texts += [f"{2**53 + 1}.{'0' * n}{rest}" for n in range(12) for rest in ("", "1")]
    texts += ["-0", "-0.0", "5.", ".5", "+5", "1e22", "1e23", "4.9e-324", "2.2250738585072011e-308"]
    texts = [text for text in texts if text not in ("inf", "-inf", "nan")]
    with open(tmp_path / "a.csv", "w", newline="") as file:
        csv.writer(file).writerows([("t", "speed"), *enumerate(texts)])
    spec = rvmon.loads("spec s\nsignal speed : real\nrequirement R\n  always speed < 1\n")
    (piece,) = spec.recording(tmp_path / "a.csv").pieces()
    found = piece.signals["speed"].values.tolist()
    assert list(map(repr, found)) == [repr(float(text)) for text in texts]


@pytest.mark.slow
def test_dates_are_exact(tmp_path):
    rng = random.Random(2)
    texts = []
    for _ in range(1500):
        year, month, day = rng.randint(1825, 2115), rng.randint(0, 13), rng.randint(0, 32)
        clock = f"{rng.randint(0, 25):02d}:{rng.randint(0, 60):02d}:{rng.randint(0, 61):02d}"
        part = rng.choice(["", ".5", ",25", f".{rng.randrange(10**9):09d}", ".1234567890", "."])
        zone = rng.choice(["", "Z", "z", " Z", " ", "+02:00", "-23:59", "+24:00", "+0100", "+1"])
        texts.append(f"{year}-{month:02d}-{day:02d}{rng.choice('T tx')}{clock}{part}{zone}")
    texts += ["2024-02-29T00:00:00", "1900-02-29T00:00:00", "0000-01-01T00:00:00", "2024-05-01"]
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R\n  always p\n").reading(time="t:iso")
    path = tmp_path / "a.csv"
    for text in texts:
        path.write_text(f"t,p\n{text},1\n")
        assert read(spec.recording(path)) == read(samples_of_csv(spec, path)), text


@pytest.mark.parametrize(
    ("slots", "kind"), [([], 6), ([1], 6), ([-2], 6), ([0], -1), ([0], 16), ([0], 2**31 - 1)]
)
def test_columns_that_do_not_exist_are_refused(slots, kind):
    """The tables of the C reader are indexed by them; an empty row would have no end."""

    def read(slots, kind):
        """The number of rows that are read of a text."""
        arrays = np.zeros((1, 4), np.int64), np.zeros((1, 4), np.uint8), np.zeros(4, np.int64)
        labels = np.zeros((4, 4), np.int64), np.zeros((4, 4), np.int64), np.zeros(8, np.int32)
        packed = np.array(slots, np.int32).tobytes(), np.array([kind], np.int32).tobytes()
        return native_csv.read(b"1\n2\n", 0, True, 9, *packed, None, *arrays, *labels)[1]

    assert [read([0], 6), read([0], 15)] == [2, 2]
    with pytest.raises(ValueError, match="do not fit"):
        read(slots, kind)
