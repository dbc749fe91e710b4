"""Arrays and Arrow tables are read like lists of the same values."""

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError

BOUND = "spec s\nsignal x : real\nrequirement R1\n  always x < 5\n"
LIMIT = 2**62
BEYOND = [[0, LIMIT], [-LIMIT, 5], [0, 2**63 - 1]]


def told(spec: rvmon.Spec, trace: object, time: str) -> str:
    with pytest.raises(rvmon.TraceError) as error:
        spec.evaluate(trace, time=time)
    return str(error.value)


@pytest.mark.slow
@each(
    ("time", "stamps"),
    [
        *(("t_ns", stamps) for stamps in BEYOND),
        *(("t", stamps) for stamps in ([-(2**63), 5], [0, 4_611_686_019], [0.0, 1e300])),
        ("t", [0, np.nan]),
    ],
)
def test_stamps_beyond_the_limits_are_refused(time, stamps, tmp_path):
    """Also values that are not a number of seconds."""
    spec = rvmon.loads(BOUND)
    why = "not finite" if stamps[1] != stamps[1] else "out of range"
    if time == "t_ns":
        why = "ns is out of range: at most 2**62 ns"
    table = {time: np.array(stamps), "x": np.array([1.0, 1.0])}
    path = tmp_path / "a.parquet"
    parquet.write_table(pyarrow.table(table), path)
    for trace in (table, pyarrow.table(table), {time: stamps, "x": [1.0, 1.0]}):
        assert why in told(spec, trace, time)
    found = told(spec, path, time)
    assert found.startswith(f"{path}: row {1 if stamps[0] else 2}: time ")
    assert why.partition(":")[0] in found


@each("last", [4_611_686_018, 4_611_686_018.25, -4_611_686_018.25, 4.605e9])
def test_seconds_up_to_the_limits_are_taken(last):
    spec = rvmon.loads(BOUND)
    stamps = sorted([0, last])
    lists = spec.evaluate({"t": stamps, "x": [1.0, 7.0]})
    arrays = spec.evaluate({"t": np.array(stamps), "x": np.array([1.0, 7.0])})
    assert arrays == lists
    assert arrays.attempts[0].decided == int(stamps[1] * 4) * 10**9 // 4


@pytest.mark.slow
@pytest.mark.parametrize("rows", [3, 3000])
def test_masked_values_are_no_updates_and_infinite_numbers_are_values(rows):
    """Sums over a column may overflow or be NaN, without a warning."""
    spec = rvmon.loads(BOUND)
    times = np.arange(float(rows))
    hidden = np.resize([1.0, 9.0, 1.0], rows)
    masked = np.ma.array(hidden, mask=hidden > 5), np.where(hidden > 5, None, hidden)
    infinite = ([np.inf, -np.inf, 1e308], [1e308, 1e308, 1e308], [np.nan, np.inf, -np.inf])
    pairs = [masked, *((column, column) for column in (np.resize(one, rows) for one in infinite))]
    reports = []
    for column, values in pairs:
        reports.append(spec.evaluate({"t": times, "x": column}))
        lists = spec.evaluate({"t": times.tolist(), "x": values.tolist()})
        assert (reports[-1].verdicts, reports[-1].health) == (lists.verdicts, lists.health)
    assert [one.verdicts["R1"] for one in reports] == ["P", "F", "F", "F"]


def test_the_time_column_is_no_signal():
    spec = rvmon.loads("spec s\nsignal t : real\nrequirement R1\n  always t < 5\n")
    table = {"t": np.array([0.0, 1.0])}
    with pytest.raises(rvmon.errors.MissingNameError, match="`t`, read by R1"):
        spec.evaluate(table)
    reports = [
        spec.evaluate(trace, allow_missing=["t"])
        for trace in (table, {"t": [0.0, 1.0]}, pyarrow.table(table))
    ]
    assert reports[0] == reports[1] == reports[2]
    assert reports[0].verdicts == {"R1": "I"}
    assert {one.kind.value for one in reports[0].health} == {"absent"}


def test_truth_values_of_record_batches_are_read():
    spec = rvmon.loads("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
    columns = {"t": pyarrow.array([0.0, 1.0]), "p": pyarrow.array([True, False])}
    batch = pyarrow.RecordBatch.from_pydict(columns)
    assert spec.evaluate(batch) == spec.evaluate(pyarrow.table(columns))
    assert spec.evaluate(batch).verdicts == {"R1": "F"}


@each("name", ["t", "x"])
def test_two_columns_of_a_name_are_refused(name):
    names = ["t", "x", name]
    table = pyarrow.table([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]], names)
    with pytest.raises(rvmon.TraceError, match=f"column `{name}` appears twice in the table"):
        rvmon.loads(BOUND).evaluate(table)


@each("unit", ["s", "ns"])
@each("time", ["t", "t_ns"])
def test_durations_count_from_their_start_and_dates_are_instants(time, unit, tmp_path):
    spec, path = rvmon.loads(BOUND), tmp_path / "a.parquet"

    def traces(name, times, **others):
        table = {name: times, "x": np.array([1.0, 1.0]), **others}
        parquet.write_table(pyarrow.table(table), path)
        return table, pyarrow.table(table), path

    for kind in ("datetime64", "timedelta64"):
        for trace in traces(time, np.array([3, 4], f"{kind}[{unit}]")):
            assert spec.evaluate(trace, time=time).end == 4 * (10**9 if unit == "s" else 1)
    for trace in traces("t", np.array([3, "NaT"], f"timedelta64[{unit}]")):
        assert "row " in told(spec, trace, "t")
    for trace in traces("t", [0, 1], x=np.array([3, 4], f"datetime64[{unit}]"))[:2]:
        assert "`x`: expected a number, found '1970" in told(spec, trace, "t")


@each("kind", ["datetime64", "timedelta64"])
def test_dates_are_no_instants_of_pairs(kind):
    spec, when = rvmon.loads(BOUND), np.array([3], f"{kind}[ns]")[0]
    for judge in (lambda: spec.evaluate([(when, {})]), lambda: spec.monitor().step(when, {})):
        with pytest.raises(TraceError, match="give seconds as a number"):
            judge()


@each("wrong", [5, None, 2.5, "soon", b"1", np.array(3), np.float64(1)])
@each("name", ["t", "x"])
def test_what_is_no_column_is_refused(name, wrong):
    table = {"t": [0, 1], "x": [1.0, 1.0], name: wrong}
    with pytest.raises(rvmon.TraceError, match=f"column `{name}`: expected an array or a list"):
        rvmon.loads(BOUND).evaluate(table)


def test_wide_floats_are_refused():
    """A number wider than a double would be rounded, so it is an error."""
    table = {"t": np.arange(3000.0), "x": np.ones(3000, np.longdouble)}
    assert "`x`: expected a number" in told(rvmon.loads(BOUND), table, "t")
