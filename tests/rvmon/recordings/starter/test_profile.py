"""The column kinds found by the CSV reader agree with a reference that reads cell by cell."""

import csv
import random

import pytest
from tests.tools.each import each

from rvmon.errors import TraceError
from rvmon.recordings import csv_batch, places
from rvmon.recordings.csv_rows import split_lines
from rvmon.recordings.starter.declarations import SeenValues, shapes_seen
from rvmon.recordings.starter.profile import shapes_of
from rvmon.trace.stamps import stamps_of

CELLS = [
    *["0", "1", "7", "-3", "+4", "007", "-0", "9" * 18, "9" * 19, "-" + "9" * 19, "1" * 130],
    *["1.5", ".5", "5.", "1e5", "-2E-3", "1e400", "1e12345", "0.10000000000000000555111512312578"],
    *["nan", "NaN", "inf", "-Infinity", "1_000", "0x10", "1e", ".", "-", "1.2.3", "1,5", "\u0663"],
    *["true", "FALSE", "tRue", "idle", "a b", "é" * 40, 'say "hi"', "1\n2", "\xa05", "\xa0", "NA"],
]
SOME = [[""], ["0", "1"], ["4", "15"], ["1.5", "2.25"], ["true", "False"], ["idle", "busy"], CELLS]


def _random_text(rng: random.Random) -> str:
    columns = [rng.choice(SOME) for _ in range(rng.randint(1, 4))]
    lines = ["t," + ",".join(f"c{place}" for place in range(len(columns)))]
    for t in range(rng.randrange(60)):
        cells = [str(t)]
        for column in columns:
            cell = rng.choice(rng.choice([column] * 30 + [CELLS]))
            is_quoted = any(sign in cell for sign in ',"\n') or rng.random() < 0.05
            cell = '"' + cell.replace('"', '""') + '"' if is_quoted else cell
            cells.append(f" {cell}" if cell[:1] not in ('"', "") and rng.random() < 0.02 else cell)
        lines.append(",".join(cells))
    end = rng.choice(["\n", "\n", "\r\n", "\r"])
    return rng.choice(["", "\ufeff"]) + end.join(lines) + rng.choice(["", end, end + end])


def _cell_by_cell(path):
    """The result of the csv module, examining each cell separately."""
    with open(path, encoding="utf-8-sig", newline="") as text:
        (_, header), *rows = split_lines(text)
    seen = {name: SeenValues() for name in header[1:]}
    for _, row in rows:
        for name, cell in zip(header[1:], row[1:], strict=True):
            seen[name].add_texts([cell])
    return shapes_seen(seen)


@each("seed", range(400))
def test_the_reader_finds_what_cells_say_one_by_one(seed, tmp_path, monkeypatch):
    path, rng = tmp_path / "a.csv", random.Random(seed)
    path.write_text(_random_text(rng), encoding="utf-8", newline="")
    monkeypatch.setattr(places, "BLOCK", rng.choice([64, 500, 1 << 20]))
    monkeypatch.setattr(csv_batch, "_LABELS", rng.choice([1, 6, 2048]))
    assert shapes_of(str(path)) == _cell_by_cell(path)


def test_a_row_that_only_python_can_read_is_examined(tmp_path, monkeypatch):
    """Its cell has the maximal length in characters, and more bytes."""
    path = tmp_path / "a.csv"
    path.write_text(f"t,x,y\n0,{'é' * 20},3\n1,{'é' * 20},\n2,,\n")
    limit = csv.field_size_limit(30)
    try:
        assert shapes_of(str(path)) == _cell_by_cell(path)
    finally:
        csv.field_size_limit(limit)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,x\n0,1\n1\n2,a\0b\n", "line 3: 1 cells where the header has 2"),
        ("t,x\n0,1\n1,a\0b\n2\n", "line 3: there are zero bytes"),
        ("t,x,x\n0,1,2\n", "`x` appears twice"),
        ("t,x [m],x [km]\n0,1,2\n", "`x` appears twice"),
    ],
)
def test_what_is_wrong_first_is_told(text, message, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(TraceError, match=message):
        shapes_of(str(path))


def test_a_unit_is_of_the_column_that_it_stands_behind(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("t,x,x [m],y [m],z [m]\n0,1.5,2.5,3.5,a\n")
    declared = shapes_of(str(path)).declared
    assert {name: shape.unit for name, shape in declared.items()} == {
        "x": "",
        "x [m]": "",
        "y": "m",
        "z": "",
    }


def test_the_time_may_have_a_unit_in_its_name(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("at [ms],at,x [m]\n0,5,1.5\n")
    assert list(shapes_of(str(path), stamps_of("at [ms]:ms")).declared) == ["at", "x"]
    path.write_text("at [ms],x [m]\n0,1.5\n")
    assert list(shapes_of(str(path), stamps_of("at [ms]:ms")).declared) == ["x"]
