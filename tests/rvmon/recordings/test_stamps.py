"""Stamps in the units of recordings."""

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from tests.tools.each import each

import rvmon
from rvmon.cli import main

SPEC = "spec s\nsignal x : real\nrequirement R1\n  always x < 5\n"
EPOCH = 1_714_557_600_123_456_789
ISO = "2024-05-01T12:00:00.123456789+02:00"


@pytest.fixture
def spec():
    return rvmon.loads(SPEC)


def ends(spec, folder, stamps, time):
    table = {"at": stamps, "x": [1.0] * len(stamps)}
    rows = "".join(f"{stamp},1\n" for stamp in stamps)
    (folder / "a.csv").write_text(f"at,x\n{rows}")
    parquet.write_table(pyarrow.table(table), folder / "a.parquet")
    lines = (f'{{"at": {stamp!r}, "x": 1}}\n'.replace("'", '"') for stamp in stamps)
    (folder / "a.jsonl").write_text("".join(lines))
    arrays = {"at": np.array(stamps), "x": np.array(table["x"])}
    files = [folder / f"a.{ending}" for ending in ("csv", "parquet", "jsonl")]
    traces = [*files, table, arrays, pyarrow.table(table)]
    return {spec.evaluate(trace, time=time).end for trace in traces}


@each(
    ("stamps", "unit", "end"),
    [
        ([1, 2], "s", 2_000_000_000),
        ([0, 1_714_557_600_123], "ms", 1_714_557_600_123_000_000),
        ([0, 1_714_557_600_123_457], "us", 1_714_557_600_123_457_000),
        ([0, EPOCH], "ns", EPOCH),
        ([0.5, 12.000001], "ms", 12_000_001),
        ([0.5, 12.25], "us", 12_250),
        (["2024-05-01", ISO], "iso", EPOCH),
        (["1969-12-31T23:59:59.999999999Z", "1970-01-01 00:00:01"], "iso", 1_000_000_000),
    ],
)
def test_every_door_reads_every_unit_exactly(spec, tmp_path, stamps, unit, end):
    assert ends(spec, tmp_path, stamps, f"at:{unit}") == {end}


@each(
    ("stamp", "unit", "told"),
    [
        ("1.5", "ns", "not a whole number of nanoseconds"),
        ("x", "ms", "not a number of milliseconds"),
        ("2024-13-01", "iso", "does not exist"),
        ("2024-05-01T12:00:00.1234567891", "iso", "at most nine digits"),
        ("12", "iso", "not a date and time of ISO 8601"),
        ("9999-01-01", "iso", "out of range"),
        ("9" * 20, "ms", "out of range"),
        # The intended unit is named.
        ("1714557600123", None, "Are these milliseconds. `--time t:ms`"),
        ("1714557600123456", None, "Are these microseconds. `--time t:us`"),
        ("1714557600123456789", None, "Are these nanoseconds. `--time t:ns`"),
        (ISO, None, "is this ISO 8601. `--time t:iso`"),
    ],
)
def test_what_is_no_stamp_is_named_with_its_line(spec, tmp_path, stamp, unit, told):
    path = tmp_path / "a.csv"
    path.write_text(f"t,x\n{stamp},1\n")
    with pytest.raises(rvmon.TraceError, match=f"line 2: time .*{told}"):
        spec.evaluate(path, time=unit and f"t:{unit}")


def doubts(spec, trace, time=None):
    return [one.remark for one in spec.evaluate(trace, time=time).health if one.kind == "unit"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stamps", "doubtful"),
    [
        ([20 * k for k in range(50)], True),
        ([20.5 * k for k in range(1200)], True),
        ([20.5 * k for k in range(500)], False),
        (list(range(50)), False),
        ([0.02 * k for k in range(2000)], False),
        ([60 * k for k in range(9)], False),
    ],
)
def test_steps_that_look_like_milliseconds_are_doubted(spec, tmp_path, stamps, doubtful):
    """Whole steps of 5 s or more, or a thousand rows of 10,000 s, in every format."""
    table = {"t": stamps, "x": [1.0] * len(stamps)}
    arrays = {name: np.array(column) for name, column in table.items()}
    (tmp_path / "a.csv").write_text("t,x\n" + "".join(f"{t},1\n" for t in stamps))
    (tmp_path / "a.jsonl").write_text("".join(f'{{"t": {t}, "x": 1}}\n' for t in stamps))
    for trace in (table, arrays, tmp_path / "a.csv", tmp_path / "a.jsonl"):
        found = doubts(spec, trace)
        assert len(found) == doubtful
        assert all("are these milliseconds? `--time t:ms`" in remark for remark in found)
        assert not doubts(spec, trace, "t:s")
        assert not doubts(spec, trace, "t:ms")


def test_nanoseconds_of_lines_are_not_doubted(spec, tmp_path):
    path = tmp_path / "a.jsonl"
    path.write_text("".join(f'{{"t_ns": {20_000_000_000 * k}, "x": 1}}\n' for k in range(20)))
    assert not doubts(spec, path)


def test_a_wrong_name_or_unit_is_told(spec, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("stamp,x\n0,1\n")
    with pytest.raises(rvmon.TraceError, match="did you mean `stamp`"):
        spec.evaluate(path, time="stmp:ms")
    with pytest.raises(rvmon.TraceError, match="the units are s, ms, us, ns, iso"):
        spec.evaluate(path, time="stamp:msec")
    with pytest.raises(rvmon.TraceError, match="name it with --time"):
        spec.evaluate(path)


def test_nested_stamps_of_lines_are_found(spec, tmp_path):
    path = tmp_path / "a.jsonl"
    path.write_text('{"header": {"stamp": 5, "x": 9}, "x": 1}\n')
    assert spec.evaluate(path, time="header.stamp:ns").end == 5


def test_the_command_line_warns(tmp_path, monkeypatch, capsys, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("t,x\n" + "".join(f"{20 * k},1\n" for k in range(50)))
    assert main(["run", "s.rv", "a.csv", "--format", "json"]) == 0
    assert "warning: a.csv: `t`: stamps are 20 s apart" in capsys.readouterr().err
    assert "t  warning: stamps are 20 s apart" in says(0, "run", "s.rv", "a.csv").out
    shown = says(0, "run", "s.rv", "a.csv", "--time", "t:ms")
    assert "warning" not in shown.out + shown.err
    assert "to 0.98 s" in shown.out
    (tmp_path / "a.csv").write_text("t,x\n0,1\n1,1")
    assert main(["run", "s.rv", "a.csv", "--format", "json"]) == 0
    assert "warning: a.csv: `the last line`: it has no end: if" in capsys.readouterr().err


def of_clocks(report):
    return [one.remark for one in report.health if one.kind == "clock"]


def test_one_stamp_of_another_clock_is_a_finding(spec, tmp_path):
    """One of 1970, as in messages without a stamp: in every format, at any position."""
    since_1970 = 1_700_000_000
    for stamps in ([5, since_1970, since_1970 + 1], [since_1970, since_1970 + 2**30]):
        table = {"t": stamps, "x": [1.0] * len(stamps)}
        path = tmp_path / "a.csv"
        path.write_text("t,x\n" + "".join(f"{t},1\n" for t in stamps))
        pairs = [(t, {"x": 1.0}) for t in stamps]
        for trace in (table, path, pairs):
            [remark] = of_clocks(spec.evaluate(trace))
            assert "years: is one of them from another clock?" in remark
    assert (
        f"from 5 s to {since_1970} s there are 53.9 years"
        in of_clocks(spec.evaluate([(5, {"x": 1.0}), (since_1970, {"x": 1.0})]))[0]
    )
    assert not of_clocks(spec.evaluate({"t": [0, 86_400 * 300], "x": [1.0, 1.0]}))


def test_a_message_of_1970_in_a_bag_is_a_finding(spec, tmp_path):
    bags = pytest.importorskip("tests.tools.bags")
    pytest.importorskip("rosbags")
    sent = [("/temp", t, {"data": 1.0}) for t in (7, bags.START, bags.START + 5)]
    path = bags.write_ros1(tmp_path / "a.bag", sent)
    assert "53.9 years" in of_clocks(spec.evaluate(path, columns={"x": "/temp"}))[0]


NS = np.array([EPOCH, EPOCH + 1, EPOCH + 1_000_000_002], np.int64)
DATES = NS.astype("datetime64[ns]")
X = [1.0, 5.0, 1.0]


def pandas_frames(module):
    dates = module.to_datetime(NS)
    yield module.DataFrame({"t": dates, "x": X})
    yield module.DataFrame({"x": X}, index=module.Index(dates, name="t"))
    yield module.DataFrame({"x": X}, index=dates)
    yield module.DataFrame({"t": dates.tz_localize("UTC").tz_convert("Asia/Tokyo"), "x": X})


def test_columns_of_dates_are_recognised(spec, tmp_path):
    """Without an option, in NumPy, Arrow, pandas, polars and Parquet."""
    table = pyarrow.table({"t": pyarrow.array(DATES), "x": X})
    parquet.write_table(table, tmp_path / "a.parquet")
    polars = pytest.importorskip("polars").DataFrame({"t": DATES, "x": X})
    frames = pandas_frames(pytest.importorskip("pandas"))
    for trace in ({"t": DATES, "x": X}, table, tmp_path / "a.parquet", polars, *frames):
        report = spec.evaluate(trace)
        assert (report.attempts[0].decided, report.end) == (EPOCH + 1, EPOCH + 1_000_000_002)
    assert spec.evaluate({"at": DATES, "x": X}, time="at") == spec.evaluate({"t": DATES, "x": X})
    with pytest.raises(rvmon.TraceError, match="row 1: time `NaT`"):
        spec.evaluate({"t": np.array(["2024-05-01", "NaT"], "datetime64[ns]"), "x": [1.0, 2.0]})
