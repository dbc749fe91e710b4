"""Parquet files with odd columns, and damaged ones: read like rows, or refused with the cause."""

import struct

import pyarrow as pa
import pytest
from pyarrow import parquet

import rvmon

SPEC = """
spec door "A door"
signal shut : bool
event knock
requirement R1
  upon knock
  then immediately shut
"""


def judged(tmp_path, **columns) -> str:
    table = {"t": [0.0, 1.0, 2.0], "shut": [False, True, True], "knock": [False, True, False]}
    parquet.write_table(pa.table(table | columns), tmp_path / "a.parquet")
    return str(rvmon.loads(SPEC).evaluate(tmp_path / "a.parquet").verdicts["R1"])


def test_an_event_of_which_nothing_is_said_does_not_occur(tmp_path):
    assert judged(tmp_path) == "P"
    assert judged(tmp_path, knock=pa.array([None] * 3, pa.bool_())) == "NT"
    assert judged(tmp_path, knock=pa.array([None] * 3)) == "NT"


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"knock": [None, {"a": 1}, None]}, "`knock` has no field `a`"),
        ({"t": [False, True, True]}, "row 1: time `False` is not a number of seconds"),
        ({"knock": [None, 2, 0]}, "sample at 1 s: `knock` is an event: .* found 2"),
        ({"shut": [None, None, 2]}, "sample at 2 s: `shut`: expected True or False, found 2"),
        ({"shut": [0.0, 1.0, 0.5]}, "sample at 2 s: `shut`: expected True or False, found 0.5"),
    ],
)
def test_columns_of_another_type_are_refused(columns, message, tmp_path):
    with pytest.raises(rvmon.TraceError, match=message):
        judged(tmp_path, **columns)


@pytest.mark.parametrize("one", [1, 1.0])
def test_numbers_are_truth_values_where_these_are_declared(one, tmp_path):
    zero = type(one)(0)
    assert judged(tmp_path, knock=[zero, one, None], shut=[zero, one, one]) == "P"
    assert judged(tmp_path, knock=[zero, one, None], shut=[zero, None, one]) == "F"


@pytest.mark.parametrize("part", ["page", "footer", "all"])
def test_a_damaged_file_is_refused_with_its_name(part, tmp_path):
    judged(tmp_path)
    path = tmp_path / "a.parquet"
    data = bytearray(path.read_bytes())
    footer = len(data) - 8 - int.from_bytes(data[-8:-4], "little")
    data[4 if part == "page" else footer] ^= 0xFF
    path.write_bytes(b"t,p\n" if part == "all" else data)
    with pytest.raises(rvmon.TraceError, match=r"a\.parquet: .*Parquet file"):
        rvmon.loads(SPEC).evaluate(path)


@pytest.mark.slow
@pytest.mark.parametrize("most", [b"\xfe" + b"\xff" * 8 + b"\x01", b"\xfe\xff\xff\xff\x0f"])
def test_sizes_and_offsets_that_overflow_are_refused(most, tmp_path):
    expected = judged(tmp_path)
    path = tmp_path / "a.parquet"
    data = path.read_bytes()
    start = len(data) - 8 - int.from_bytes(data[-8:-4], "little")
    refused = 0
    for place in range(start, len(data) - 8, 17):
        footer = data[start:place] + most + data[place + 1 : -8]
        path.write_bytes(data[:start] + footer + len(footer).to_bytes(4, "little") + b"PAR1")
        try:
            found = str(rvmon.loads(SPEC).evaluate(path).verdicts["R1"])
        except rvmon.TraceError:
            refused += 1
        else:
            assert found == expected
    assert refused


def test_a_page_with_a_wrong_checksum_is_reported(tmp_path):
    """Pages have checksums if their writer set them; the damaged value would be a valid number."""
    path = tmp_path / "a.parquet"
    table = pa.table({"t": [0.0, 1.0], "x": [1.25, 1.5]})
    parquet.write_table(
        table, path, write_page_checksum=True, compression="none", use_dictionary=False
    )
    spec = rvmon.loads("spec s\nsignal x : real\nrequirement R\n  always x < 3\n")
    assert spec.evaluate(path).verdicts["R"] == "P"
    data = path.read_bytes()
    page = struct.pack("<dd", 1.25, 1.5)
    assert data.count(page) == 1
    path.write_bytes(data.replace(page, struct.pack("<dd", 1.25, 1.75)))
    with pytest.raises(rvmon.TraceError, match="CRC"):
        spec.evaluate(path)
