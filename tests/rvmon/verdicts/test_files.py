"""Verdicts are written as tables and read back unchanged."""

import csv
import sqlite3
from dataclasses import replace

import pytest
from tests.tools.hostile import hostile_names

import rvmon
from rvmon.errors import RvmonError
from rvmon.verdicts.serialise import VerdictRow, broken_rows
from rvmon.verdicts.table_file import read_results, refuse_format, write_results

SPEC = """signal speed : real
event go(id: int)
requirement R1
  upon go.id == i then within 2 s speed > 1
  for each i in go.id
requirement R2
  upon speed > 9 then within 1 s speed < 1
"""
ROWS = [
    (0.0, {"speed": 0.0}),
    (1.0, {"go": {"id": 7}}),
    (2.5, {"speed": 2.0}),
    (4.0, {"go": {"id": 8}, "speed": 0.0}),
    (7.0, {}),
    (8.0, {"go": {"id": 9}}),
]


@pytest.fixture(scope="module")
def report():
    """A passed, a failed and an open attempt of one requirement, and none of another."""
    return replace(rvmon.loads(SPEC).evaluate(ROWS), trace="a.csv")


def test_a_report_has_a_row_for_each_attempt(report):
    rows = list(report.rows())
    assert [(row.attempt, row.verdict) for row in rows] == [
        ("R1#1", "P"),
        ("R1#2", "F"),
        ("R1#3", "I"),
        (None, "NT"),
    ]
    assert rows[1].captured == '{"i":8}'
    assert (rows[0].triggered, rows[0].decided, rows[0].decided_s) == (10**9, 25 * 10**8, 2.5)
    assert rows[2].decided is None
    assert "speed" in rows[1].reason


def test_frames_keep_instants_whole():
    """Stamps since 1970 next to an open attempt: floats would round them."""
    spec = rvmon.loads(SPEC)
    origin = 1_789_000_000_123_456_789
    monitor = spec.monitor()
    monitor.step_ns(origin, {"speed": 0.0, "go": {"id": 1}})
    monitor.step_ns(origin + 1, {"speed": 2.0})
    monitor.step_ns(origin + 2, {"speed": 0.0, "go": {"id": 2}})
    found = monitor.finish()
    pytest.importorskip("pandas")
    pytest.importorskip("polars")
    assert found.to_arrow()["decided"].to_pylist() == [origin + 1, None, None]
    assert found.to_pandas()["decided"][0] == origin + 1
    assert found.to_polars()["decided"][0] == origin + 1


@pytest.mark.parametrize("end", ["csv", "parquet", "sqlite"])
def test_what_is_written_is_read_back(report, tmp_path, end):
    path = tmp_path / f"v.{end}"
    rows = [*report.rows(), *broken_rows("b.csv", "line 3: what is `x`?", report.attempts[:1])]
    write_results(path, rows, {"law": "2"})
    found = read_results(path)
    kept = ("recording", "requirement", "attempt", "verdict", "reason", "error")
    assert found == [VerdictRow(**{name: getattr(row, name) for name in kept}) for row in rows]


def test_json_is_read_as_well(report, tmp_path):
    path = tmp_path / "v.json"
    path.write_text(report.to_json())
    one = read_results(path)
    assert [row.attempt for row in one] == ["R1#1", "R1#2", "R1#3", None]
    path.write_text(
        f'[{report.to_json()},{{"law":2,"trace":"b","error":"e","judged_before":{{}}}}]'
    )
    assert read_results(path) == [*one, VerdictRow("b", error="e")]


def test_databases_say_what_judged(report, tmp_path):
    write_results(tmp_path / "v.sqlite", report.rows(), {"spec": "s.rv"})
    with sqlite3.connect(tmp_path / "v.sqlite") as database:
        query = "SELECT count(*) FROM verdicts WHERE verdict = 'F' AND decided - triggered > 2e9"
        assert database.execute(query).fetchone() == (1,)
        assert database.execute("SELECT * FROM about").fetchall() == [("spec", "s.rv")]


@pytest.mark.parametrize("end", ["csv", "parquet", "sqlite"])
def test_names_are_data(tmp_path, end):
    names = [name for name in hostile_names(60) if name and name.isprintable()]
    names.append("a\rb.csv")
    rows = [VerdictRow(name, name, f"{name}#1", 1, "P", reason=name) for name in names]
    write_results(tmp_path / f"v.{end}", rows, {})
    assert [row.recording for row in read_results(tmp_path / f"v.{end}")] == names


def test_a_table_without_rows(tmp_path):
    write_results(tmp_path / "v.csv", [], {})
    with open(tmp_path / "v.csv", encoding="utf-8") as file:
        assert next(csv.reader(file)) == list(VerdictRow._fields)
    write_results(tmp_path / "v.parquet", [], {})
    assert read_results(tmp_path / "v.parquet") == []


def test_what_is_no_file_of_verdicts_is_refused(tmp_path):
    with pytest.raises(RvmonError, match=r"v\.xls: verdicts are stored in files that end in \.csv"):
        refuse_format("v.xls")
    with pytest.raises(RvmonError, match="there is no file"):
        read_results(tmp_path / "none.csv")
    for end in ("csv", "parquet", "sqlite", "json"):
        path = tmp_path / f"v.{end}"
        for body in (b"", b"t,a\n0,1\n", b"\xff\xfe\x00", b'{"a": 1}', b"[1]", b"PAR1 PAR1"):
            path.write_bytes(body)
            with pytest.raises(RvmonError, match="contains no verdicts of rvmon"):
                read_results(path)


def test_a_verdict_that_there_is_not_is_refused(tmp_path):
    write_results(tmp_path / "v.csv", [VerdictRow("a", "R1", verdict="OK")], {})
    with pytest.raises(RvmonError, match="'OK' is not a valid Verdict"):
        read_results(tmp_path / "v.csv")


def test_a_package_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr("rvmon.verdicts.table_file.find_spec", lambda _: None)
    with pytest.raises(RvmonError, match="needs pyarrow, which is not installed: pip install"):
        refuse_format("v.parquet")
