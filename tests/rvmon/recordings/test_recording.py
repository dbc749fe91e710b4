import gzip
import os
from pathlib import Path

import pytest
from tests.tools.each import each

import rvmon
from rvmon.errors import TimeOrderError, TraceError
from rvmon.recordings.recording import FileRecording
from rvmon.trace.sample import HealthKind, Sample
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.stamps import stamps_of

SCHEMA = Schema(
    {"ok": Kind.BOOL, "hand.distance": Kind.REAL, "mode": Kind.LABEL, "n": Kind.INT},
    {"go": {}, "pick": {"id": Kind.INT}},
)


def read(tmp_path: Path, name: str, text: str | bytes, *, ordered: bool = True):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    recording = FileRecording(path, SCHEMA, ordered=ordered)
    return recording, [(sample.t, dict(sample.values)) for sample in recording]


def test_undeclared_columns_are_ignored_and_counted(tmp_path):
    recording, samples = read(tmp_path, "a.csv", "t,ok,battery,\n0,1,7,3\n")
    assert samples == [(0, {"ok": True})]
    assert [(h.kind, h.name) for h in recording.health()] == [(HealthKind.IGNORED, "battery")]
    assert recording.names == {"ok"}


UNENDED = {
    "as it is": ("a.csv", lambda text: text.encode()),
    "packed": ("a.csv.gz", lambda text: gzip.compress(text.encode())),
    "in UTF-16": ("a.CSV", lambda text: text.encode("utf-16")),
    "in a dialect": ("a.csv", lambda text: f"# by a tool\n{text}".replace(",", ";").encode()),
}


@each("end", ["", "\n", "\r\n"])
@each("form", UNENDED)
def test_a_last_line_without_its_end_is_unknown(tmp_path, form, end):
    """`12` may be the start of `125`: this is reported for every kind of file."""
    name, made = UNENDED[form]
    recording, samples = read(tmp_path, name, made(f"t,ok,n\n0,1,1\n1,1,12{end}"))
    assert samples[-1] == (10**9, {"ok": True, "n": 12 if end else None})
    found = [(one.kind, one.name) for one in recording.health()]
    assert found == ([] if end else [(HealthKind.CUT, "the last line")])


def test_of_a_last_line_without_its_end_only_the_last_cell_is_unknown(tmp_path):
    """Everything at an incomplete stamp is unknown; a bool can be recognised as complete."""
    assert read(tmp_path, "a.csv", "n,t,ok\n7,1,1")[1] == [(10**9, {"n": 7, "ok": True})]
    assert read(tmp_path, "a.csv", "n,t,ok\n7,1,")[1] == [(10**9, {"n": 7, "ok": None})]
    assert read(tmp_path, "a.csv", "t,n,go\n1,7,")[1] == [(10**9, {"n": 7, "go": None})]
    assert read(tmp_path, "a.csv", "n,ok,t\n7,1,12")[1] == [(12 * 10**9, {"n": None, "ok": None})]
    recording, samples = read(tmp_path, "a.csv", "t,n,unread\n1,7,1")
    assert samples == [(10**9, {"n": 7})]
    assert HealthKind.CUT not in [one.kind for one in recording.health()]
    two = Schema({"s": Kind.INT}, {}, stamps=stamps_of("sec+nanosec"))
    (tmp_path / "a.csv").write_text("sec,nanosec,s\n1,5,12")
    assert list(FileRecording(tmp_path / "a.csv", two)) == [Sample(1_000_000_005, {"s": None})]


def test_a_signal_that_ignores_nan_is_refused_with_an_incomplete_last_line(tmp_path):
    """It would ignore a lost value, and nothing lost may pass."""
    spec = rvmon.loads("spec s\nsignal x : real ignore NaN\nrequirement R1\n  always x < 3\n")
    (tmp_path / "a.csv").write_text("t,x\n0,1\n1,2")
    with pytest.raises(rvmon.TraceError, match="line 3: it has no end: if it was cut off, `x`"):
        spec.evaluate(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("t,x\n0,1\n1,2\n")
    assert spec.evaluate(tmp_path / "a.csv").verdicts["R1"] == "P"


BAD = {
    "text in a number": ("a.csv", "t,n\n0,1\n1,abc\n", "a.csv: line 3: column `n`: `abc`"),
    "NA in a number": ("a.csv", "t,n\n0,1\n1,NA\n", "`NA` is not a whole number: leave a cell"),
    "text in a truth value": ("a.csv", "t,ok\n0,maybe\n", "line 2: column `ok`: `maybe`"),
    "time going backwards": ("a.csv", "t,n\n1,1\n0.5,1\n", "line 3: time goes backwards"),
    "time is no number": ("a.csv", "t,n\nsoon,1\n", "line 2: time `soon`"),
    "time is NaN": ("a.csv", "t,n\nnan,1\n", "line 2: time `nan`"),
    "huge exponent": ("a.csv", "t,n\n1e999999999,1\n", "line 2: time"),
    "fraction of a tick": ("a.csv", "t_ns,n\n1.5,1\n", "line 2: time `1.5`"),
    "empty file": ("a.csv", "", "is empty"),
    "header only": ("a.csv", "t,n\n", "holds no sample"),
    "no time column": ("a.csv", "n,ok\n1,1\n", "expected one time column"),
    "time of another case": ("a.csv", "T,n\n1,1\n", "found `T`, `n`: `T` looks like it"),
    "time without a name": ("a.csv", ",n\n1,1\n", "found one without a name, `n`"),
    "both time columns": ("a.csv", "t,t_ns\n1,1\n", "found both"),
    "double column": ("a.csv", "t,n,n\n1,1,1\n", "`n` appears twice"),
    "no header": ("a.csv", "0,1,1\n1,1,1\n", "`1` appears twice in the header: are these values?"),
    "short row": ("a.csv", "t,n,ok\n1,1\n", "line 2: 2 cells where the header has 3"),
    "decimal commas": ("a.csv", "t,n,ok\n0,1,1,5\n", "header has 3: if the comma is the decimal"),
    "underscored number": ("a.csv", "t,n\n0,1_0\n", "`1_0` is not a whole number"),
    "underscored time": ("a.csv", "t,n\n1_0,1\n", "line 2: time `1_0` is not a number"),
    "underscored ticks": ("a.csv", "t_ns,n\n1_0,1\n", "line 2: time `1_0` is not a whole"),
    "late time": ("a.csv", "t,n\n10000000000,1\n", "line 2: time `10000000000` is out of range"),
    "late ticks": ("a.csv", f"t_ns,n\n{2**62},1\n", "line 2: time `4611686018427387904` is out of"),
    "very late ticks": ("a.csv", f"t_ns,n\n{'9' * 5000},1\n", "is out of range: at most 2**62 ns"),
    "very long number": ("a.csv", f"t,n\n0,-{'9' * 5000}\n", "has more than 4300 digits"),
    "very late time": ("a.csv", f"t,n\n{'9' * 5000},1\n", "999...999"),
    "blanks and cells": ("a.csv", "t,n\n   \n0,x\n", "line 3: column `n`: `x`"),
    "UTF-16": ("a.jsonl", '{"t": 0, "n": 1}\n'.encode("utf-16"), "iconv -f utf-16 -t utf-8"),
    "Latin-1": ("a.csv", "t,n\n0,1\n1,\xfc\n".encode("latin1"), "iconv -f latin1 -t utf-8"),
    "binary file": ("a.csv", b"\x7fELF\x02\x01\xff\xfe\x00" * 40, "is this a binary file?"),
    "a cell cut off": (
        "a.csv",
        "t,n\n0,1\n1,-",
        "line 3: column `n`: `-` is not a whole number; the file ends",
    ),
    "a row cut off": (
        "a.csv",
        "t,n\n0,1\n1",
        "line 3: 1 cells where the header has 2; the file ends",
    ),
    "open quote": ("a.csv", 't,n\n0,"1\n', "not a CSV row"),
    "empty JSON lines": ("a.jsonl", "\n\n", "holds no sample"),
    "truncated JSON": ("a.jsonl", '{"t": 1, "n": 1}\n{"t": 2, "n', "line 2: not a JSON object"),
    "JSON array": ("a.jsonl", "[1, 2]\n", "line 1: expected an object"),
    "JSON without time": ("a.jsonl", '{"n": 1}\n', "line 1: expected one time"),
    "JSON text in a number": ("a.jsonl", '{"t": 1, "n": "x"}\n', 'field `n`: `"x"` is not a whole'),
    "JSON truth in a number": ("a.jsonl", '{"t": 1, "n": true}\n', "field `n`: `true`"),
    "JSON late": ("a.jsonl", f'{{"t_ns": {"9" * 20}, "n": 1}}\n', "is out of range"),
    "JSON truth as time": ("a.jsonl", '{"t": false, "n": 1}\n', "line 1: time `false` is neither"),
    "JSON text as time": (
        "a.jsonl",
        '{"t": "0", "n": 1}\n',
        "time `'0'` is not a number of seconds",
    ),
    "NaN as time": ("a.csv", "t,n\n0,1\nnan,1\n", "line 3: time `nan` is not finite"),
    "no time": ("a.csv", "t,n\n0,1\n,1\n", "line 3: there is no time"),
    "JSON half pair": ("a.jsonl", '{"t": 1, "mode": "\\ud800"}\n', "half of a surrogate pair"),
    "JSON deep": ("a.jsonl", '{"t": 1, "n": ' + "[" * 100_000 + "\n", "nested too deeply"),
    "JSON bad event": ("a.jsonl", '{"t": 1, "go": "yes"}\n', "event `go`: expected true"),
    "JSON events no list": ("a.jsonl", '{"t": 1, "events": "go"}\n', 'such as ["go"]'),
    "no ending": ("a", "t\n", "the name has no ending"),
    "unknown ending": ("a.xyz", "t\n", "the ending `.xyz` is not a known format"),
}


@each("name", BAD)
def test_bad_input_is_named_with_file_and_line(tmp_path, name):
    file, text, message = BAD[name]
    with pytest.raises(TraceError) as caught:
        read(tmp_path, file, text)
    assert message in str(caught.value)
    assert file in str(caught.value)


def test_samples_before_a_broken_line_are_returned(tmp_path):
    """All but those of the last stamp, to which the broken line may belong."""
    path = tmp_path / "a.csv"
    path.write_text("t,n\n0,1\n1,2\n2,x\n")
    stream = iter(FileRecording(path, SCHEMA))
    assert next(stream).t == 0
    with pytest.raises(TraceError, match="line 4"):
        next(stream)


def test_unordered_recordings_pass_where_lateness_is_allowed(tmp_path, monkeypatch):
    monkeypatch.setattr("rvmon.recordings.rows.ROOM", 2)
    _, samples = read(tmp_path, "a.csv", "t,n\n1,1\n0.5,1\n0.5,2\n", ordered=False)
    assert [(t, values["n"]) for t, values in samples] == [(5 * 10**8, 2), (10**9, 1)]
    with pytest.raises(TimeOrderError, match=r"line 5: 0.5 s comes more than 2 lines late"):
        read(tmp_path, "a.csv", "t,n\n1,1\n2,1\n3,1\n0.5,1\n", ordered=False)
    with pytest.raises(TimeOrderError):
        read(tmp_path, "a.csv", "t,n\n1,1\n0.5,1\n")


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("a.csv", "t,n\r\n1,4\r\n"),
        ("a.csv", '"t","n"\n1,4\n'),
        ("a.jsonl", '{"t": 1, "n": 4}\r\n'),
    ],
)
def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path, file, text):
    _, samples = read(tmp_path, file, "\ufeff" + text)
    assert samples == [(1_000_000_000, {"n": 4})]


@each("number", ["1e400", "-1e400", "9" * 400])
@each("form", ["a.csv", "a.jsonl", "b.jsonl"])
def test_a_number_too_large_for_a_double_is_refused(tmp_path, number, form):
    text = {
        "a.csv": f"t,x\n0,{number}\n",
        "a.jsonl": f'{{"t":0,"x":{number}}}\n',
        "b.jsonl": f'{{"t":0,"x":{number},"y":NaN}}\n',
    }[form]
    (tmp_path / form).write_text(text)
    with pytest.raises(TraceError, match=r"line [12]: "):
        list(FileRecording(tmp_path / form, Schema({"x": Kind.REAL}, {})))


@pytest.mark.parametrize(("cell", "word"), [("inf", "Infinity"), ("-inf", "-Infinity")])
def test_what_is_called_infinite_is(tmp_path, cell, word):
    (tmp_path / "a.csv").write_text(f"t,x\n0,{cell}\n")
    (tmp_path / "a.jsonl").write_text(f'{{"t":0,"x":{word}}}\n')
    for name in ("a.csv", "a.jsonl"):
        (sample,) = FileRecording(tmp_path / name, Schema({"x": Kind.REAL}, {}))
        assert sample.values == {"x": float(cell)}


def test_a_row_of_quoted_lines_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr("rvmon.recordings.csv_rows.LONGEST_LINE", 1000)
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R\n  always p\n")
    path = tmp_path / "a.csv"
    path.write_text("t,p\n0,1\n" + '1,"\n"' + ',"\n"' * 300 + "\n2,1\n")
    with pytest.raises(rvmon.TraceError, match=r"line 3: a row of more than 1,000 .* quotes"):
        list(spec.recording(path))
    path.write_text("t,p\n0,1\n" + '1,"' + "\n" * 200_000)
    with pytest.raises(rvmon.TraceError, match=r"begins on line 3|begins here: close its quotes"):
        list(spec.recording(path))


@pytest.mark.parametrize(("name", "row"), [("a.csv", "1,{}\n"), ("a.jsonl", '{{"t":1,"x":{}}}\n')])
def test_a_line_that_is_too_long_is_named(tmp_path, monkeypatch, name, row):
    for module in ("places", "csv_rows"):
        monkeypatch.setattr(f"rvmon.recordings.{module}.LONGEST_LINE", 1 << 18)
    above = "t,x\n" if name == "a.csv" else row.format(0)
    (tmp_path / name).write_text(above + row.format(2) + row.format("1" * (1 << 21)))
    with pytest.raises(TraceError, match="line 3: longer than 262,144 characters"):
        list(FileRecording(tmp_path / name, Schema({"x": Kind.REAL}, {})))


def test_a_small_text_is_read_once(tmp_path):
    """The content at the time of the header counts; another iteration reads the file again."""
    path = tmp_path / "a.csv"
    path.write_text("t,ok\n0,1\n1,0\n")
    recording = FileRecording(path, SCHEMA)
    path.write_text("t,ok\n0,0\n")
    first, second = list(recording), list(recording)
    assert [dict(one.values) for one in first] == [{"ok": True}, {"ok": False}]
    assert [dict(one.values) for one in second] == [{"ok": False}]


def test_recordings_with_different_headers_are_read_by_their_own(tmp_path):
    """The layout of one header is not reused for another one."""
    texts = ["t,ok,n\n0,1,3\n", "t,n,ok\n0,4,0\n", "t,ok,n\n0,0,5\n"]
    found = [read(tmp_path, f"{place}.csv", text)[1] for place, text in enumerate(texts)]
    assert [samples[0][1] for samples in found] == [
        {"ok": True, "n": 3},
        {"ok": False, "n": 4},
        {"ok": False, "n": 5},
    ]


def test_rows_before_a_broken_end_of_a_text_are_returned(tmp_path):
    """An incomplete character ends the text; the rows before it count."""
    path = tmp_path / "a.csv"
    path.write_bytes(b"t,ok\n0,1\n1,0\n2,\xc3")
    samples = []
    with pytest.raises(TraceError, match="not UTF-8 text"):
        samples.extend(FileRecording(path, SCHEMA))
    assert samples == [Sample(0, {"ok": True})]


@pytest.mark.parametrize("name", ["a.csv", "a.parquet"])
def test_a_pipe_of_columns_is_refused(tmp_path, name):
    """A table is examined before it is read, which a pipe does not allow."""
    os.mkfifo(tmp_path / name)
    with pytest.raises(TraceError, match=f"{name}: is a pipe: pipes hold JSON lines"):
        FileRecording(tmp_path / name, SCHEMA)
