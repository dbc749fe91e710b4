"""Columns of dates are read as what they are, without being told."""

import numpy as np
import pytest

import rvmon

SPEC = "spec s\nsignal x : real\nrequirement R1\n  upon rise(x > 1)\n  then within 1 s x > 2\n"
START = 1_700_000_000_000_000_000
NS = np.array([START, START + 1, START + 1_000_000_002], np.int64)
X = [0.0, 2.0, 3.0]


def decided(table, **reading):
    """When the only attempt was triggered and decided."""
    [attempt] = rvmon.loads(SPEC).evaluate(table, **reading).attempts
    return attempt.triggered, attempt.decided, attempt.verdict


EXPECTED = decided({"t_ns": NS, "x": X})


def pandas_frames(module):
    dates = module.to_datetime(NS)
    yield module.DataFrame({"t": dates, "x": X})
    yield module.DataFrame({"x": X}, index=module.Index(dates, name="t"))
    yield module.DataFrame({"x": X}, index=dates)
    yield module.DataFrame({"t": dates.tz_localize("UTC").tz_convert("Asia/Tokyo"), "x": X})


def test_dates_of_numpy_and_pandas():
    assert decided({"t": NS.astype("datetime64[ns]"), "x": X}) == EXPECTED
    assert decided({"at": NS.astype("datetime64[ns]"), "x": X}, time="at") == EXPECTED
    for frame in pandas_frames(pytest.importorskip("pandas")):
        assert decided(frame) == EXPECTED


def test_dates_of_polars_arrow_and_parquet(tmp_path):
    polars = pytest.importorskip("polars")
    arrow = pytest.importorskip("pyarrow")
    dates = NS.astype("datetime64[ns]")
    assert decided(polars.DataFrame({"t": dates, "x": X})) == EXPECTED
    table = arrow.table({"t": arrow.array(dates), "x": X})
    assert decided(table) == EXPECTED
    path = tmp_path / "a.parquet"
    pytest.importorskip("pyarrow.parquet").write_table(table, path)
    assert decided(path) == EXPECTED


def test_a_date_that_is_none_is_told():
    with pytest.raises(rvmon.TraceError, match="row 1: time `NaT`"):
        decided({"t": np.array(["2024-05-01", "NaT"], "datetime64[ns]"), "x": [1.0, 2.0]})
