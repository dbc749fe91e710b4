"""The same content gives the same report from every format."""

import json
import random
from dataclasses import replace

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from tests.tools.differential import cases_of
from tests.tools.doors import content_of, doors, in_pieces, told, whole
from tests.tools.each import each

import rvmon
from rvmon.errors import MissingNameError, TraceError, UnknownNameError
from rvmon.recordings.source import Source
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.trace.sample import HealthKind, Trace

NAN = float("nan")
BASE = """
spec base
signal speed : real
signal gear : int
signal on : bool
signal mode : {idle, busy}
event pick(id : int)
requirement R1
  always speed < 3
requirement R2
  upon pick.id > 2
  then immediately gear > 1
requirement R3
  always (on or mode == idle)
"""


def bare(report):
    """Verdicts, records without reasons, and input health.

    The core does not report staleness of names that no requirement reads. The hint that unknown
    values alternate with known ones is of rows, before those of equal stamps are merged.
    """
    attempts = [
        (
            *(one.requirement, one.number, one.in_doubt, one.triggered, one.decided),
            *(one.verdict, one.decision, dict(one.captured)),
        )
        for one in report.attempts
    ]
    told = [
        replace(one, remark="") if one.kind is HealthKind.NAN else one
        for one in report.health
        if one.kind is not HealthKind.STALE or one.requirements
    ]
    return dict(report.verdicts), attempts, told, report.origin, report.end, dict(report.counts)


def judged(spec, trace, **arguments):
    return spec.evaluate(trace, allow_missing=True, **arguments)


@pytest.mark.law
@pytest.mark.parametrize("seed", range(20))
def test_every_door_is_judged_as_its_samples_are(seed, tmp_path):
    traces = TraceProfile(12, 48, advances=False)
    spec = None
    for part, case in enumerate(cases_of(f"doors/{seed}", Profile(), traces, 2)):
        spec = spec or Spec(case.spec)
        content = content_of(random.Random(seed), case)
        content = whole(content) if part == 1 else content
        found = {}
        for door, write in doors().items() if content.rows else ():
            trace, arguments = write(content, tmp_path)
            found[door] = told(spec, trace, **arguments)
            if seed % 4 == 0:
                recording = spec.recording(trace, allow_missing=True, **arguments)
                one_by_one = Trace(tuple(recording), recording.names, recording.end)
                for end in (None, content.rows[len(content.rows) // 2][0]):
                    expected = spec.judge(Source(one_by_one, end, is_cut=end is not None))
                    with in_pieces(200):
                        pieces = spec.recording(trace, allow_missing=True, **arguments)
                        report = spec.judge(Source(pieces, end, is_cut=end is not None))
                    assert bare(report) == bare(expected), door
        assert len({*found.values()}) == (1 if content.rows else 0)
        assert all(text.startswith("{") for text in found.values())


def base() -> Spec:
    return rvmon.loads(BASE)


@pytest.mark.parametrize(
    "columns",
    [
        {"on": np.array([1, 1, 0]), "gear": np.array([2.0, 3.0, 3.0])},
        {"on": np.array([1.0, 1.0, 0.0]), "gear": [np.int64(2), 3.0, 3]},
        {"on": [np.True_, 1, 0], "gear": np.array([2, 3, 3], np.int16)},
        {"on": np.array([1, 1, 0], np.uint8), "gear": np.ma.array([2, 3, 9], mask=[0, 0, 1])},
    ],
)
def test_values_are_taken_as_declared(columns):
    plain = {"t": [0, 1, 2], "on": [True, True, False], "gear": [2, 3, 3]}
    modes = {"mode": np.array(["busy", "idle", "busy"])}
    assert told(base(), plain | columns | modes) == told(base(), plain | {"mode": [*modes["mode"]]})
    assert judged(base(), plain | columns | modes).verdicts["R3"] == "F"


@pytest.mark.parametrize(("name", "wrong"), [("on", 2), ("gear", 2.5), ("mode", "off")])
def test_what_is_not_declared_so_is_refused(name, wrong):
    with pytest.raises(TraceError, match=f"sample at 1 s: `{name}`: expected .*, found {wrong!r}"):
        judged(base(), {"t": [0, 1], name: [None, wrong]})


@each(
    ("name", "text", "place"),
    [
        ("a.csv", "t,mode\n0,idle\n1,off\n2,off\n", "line 3: "),
        ("a.csv", "t,mode\n0,idle\n\n1,busy\n1,off\n2,idle\n", "lines 4 to 5: "),
        ("a.csv", 't,mode\n0,idle\n1,"off\n"\n2,idle\n', "line 4: "),
        ("a.jsonl", '{"t": 0, "mode": "idle"}\n\n{"t": 1, "mode": "off"}\n', "line 3: "),
    ],
)
@each("header", ["", "max delay 1 s\n"])
def test_a_label_that_is_not_declared_is_named_with_its_line(tmp_path, name, text, place, header):
    """Within a column, and row by row, as when late rows are sorted."""
    (tmp_path / name).write_text(text)
    with pytest.raises(TraceError, match=f"^{place}sample at 1 s: `mode`: expected one of"):
        judged(rvmon.loads(BASE.replace("signal", f"{header}signal", 1)), tmp_path / name)


MERGED = {
    "t": [float(t) for t in range(8)],
    "speed": [1.0, NAN] * 4,
    "gear": [NAN, 2.0] * 4,
}


def doors_of(table, folder):
    arrays = {name: np.array(column) for name, column in table.items()}
    parquet.write_table(pyarrow.table(arrays), folder / "a.parquet")
    rows = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
    (folder / "a.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    lines = [",".join(map(str, row.values())) for row in rows]
    (folder / "a.csv").write_text("\n".join([",".join(table), *lines]) + "\n")
    files = [folder / f"a.{ending}" for ending in ("parquet", "jsonl", "csv")]
    pairs = [(row["t"], {n: v for n, v in row.items() if n != "t"}) for row in rows]
    return [table, arrays, pyarrow.table(arrays), pairs, *files]


@pytest.mark.slow
def test_a_merge_of_topics_is_told(tmp_path):
    for trace in doors_of(MERGED, tmp_path):
        report = judged(base(), trace, sources=["speed", "gear"])
        assert report.verdicts["R1"] == "I"
        found = {one.name: one.remark for one in report.health if one.kind in ("nan", "none")}
        assert all('nan="no update"' in remark for remark in found.values())
        assert set(found) == {"speed", "gear"}
        report = judged(base(), trace, sources=["speed", "gear"], nan="no update")
        assert report.verdicts["R1"] == "P"
        assert not [one for one in report.health if one.kind in ("nan", "none")]
    dropout = MERGED | {"speed": [1.0, NAN, NAN, NAN, NAN, 1.0, 1.0, 1.0]}
    for trace in doors_of(dropout, tmp_path):
        health = judged(base(), trace).health
        assert {one.remark for one in health if one.name == "speed"} == {""}


@pytest.mark.slow
def test_a_value_may_stand_for_no_update(tmp_path):
    for gap in (-1, -1.0, np.float64(-1)):
        for column in ([1.0, -1.0, 2.0], np.array([1.0, -1.0, 2.0])):
            table = {"t": np.arange(3.0), "speed": column}
            plain = {"t": [0, 1, 2], "speed": [1.0, None, 2.0]}
            assert told(base(), table, no_update=gap) == told(base(), plain)
    (tmp_path / "a.csv").write_text("t,mode,speed,on\n0,idle,1,1\n1,-,-,0\n2,-,-,-")
    rows = base().recording(tmp_path / "a.csv", no_update="-")
    assert [len(one.values) for one in rows] == [3, 1, 0]  # the last line has no end
    assert judged(base(), MERGED, no_update=NAN).verdicts["R1"] == "P"
    for wrong in ({"nan": "gap"}, {"no_update": [1]}):
        with pytest.raises(
            UnknownNameError,
            match=r"nan=.*: expected 'unknown' or 'no update'|is not a value of a cell",
        ):
            judged(base(), MERGED, **wrong)


def test_the_command_line_reads_nan_as_requested(tmp_path, says):
    """`--nan no-update` holds the previous value; without it the finding names the option."""
    spec, trace = tmp_path / "a.rv", tmp_path / "a.csv"
    spec.write_text("spec s\nsignal x : real\nrequirement R1\n  always x < 3\n")
    trace.write_text("t,x\n" + "".join(f"{t},{('1', 'nan')[t % 2]}\n" for t in range(8)))
    told = says(1, "run", spec, trace, "--strict").out
    assert "rvmon run --nan no-update" in " ".join(told.split())
    says(0, "run", spec, trace, "--strict", "--nan", "no-update")


def test_sources_of_a_stream_can_be_named():
    spec = rvmon.loads("spec s\nsignal p : bool\nevent e\nrequirement R1\n  always not e\n")
    pairs = [(0, {"p": True}), (1, {"p": True})]
    assert judged(spec, pairs).verdicts["R1"] == "P"
    assert judged(spec, pairs, sources=["p"]).verdicts["R1"] == "I"
    assert judged(spec, {"t": [0, 1], "p": [True, True]}).verdicts["R1"] == "I"
    assert judged(spec, {"t": [0, 1]}, sources=["e"]).verdicts["R1"] == "P"
    with pytest.raises(UnknownNameError, match="`z`: there are p, e"):
        judged(spec, pairs, sources=["z"])


@pytest.mark.slow
def test_all_that_read_recordings_are_told_alike(tmp_path):
    spec = rvmon.loads("spec s\nsignal x : real\nsignal y : real\nrequirement R1\n  always x < 3\n")
    (tmp_path / "a.csv").write_text("ms,X\n0,1\n1,nan\n2,-1\n3,2\n")
    table = {"ms": [0, 1, 2, 3], "X": [1.0, NAN, -1.0, 2.0]}
    how = {"time": "ms:ms", "columns": {"x": "X"}, "nan": "no update", "no_update": -1}
    for trace in (table, tmp_path / "a.csv"):
        report = spec.evaluate(trace, **how)
        assert (report.verdicts["R1"], report.end) == ("P", 3_000_000)
        assert [*spec.evaluate_many([trace], **how)] == [report]
        assert [*spec.evaluate_many([trace] * 2, jobs=2, **how)] == [report] * 2
        assert spec.reading(**how).evaluate(trace) == report
        assert spec.reading(**how).evaluate(trace, nan="unknown").verdicts["R1"] == "I"
        recording = spec.recording(trace, sources=["x"], **how)
        assert [sample.values for sample in recording] == [{"x": 1.0}, {}, {}, {"x": 2.0}]
        assert recording.names == {"x"}
        assert spec.robustness(trace, **how).attempts["R1", 1].kept == 1
        with pytest.raises(MissingNameError, match="`x`"):
            spec.robustness(trace, time="ms:ms")
        with pytest.raises(MissingNameError, match="`x`"):
            spec.recording(trace, time="ms:ms", allow_missing=["y"])


def test_no_door_goes_back_in_time(tmp_path):
    for trace in doors_of({"t": [0.0, 2.0, 1.0], "speed": [1.0, 9.0, 2.0]}, tmp_path):
        with pytest.raises(TraceError, match="time goes backwards, from 2 s to 1 s"):
            judged(base(), trace)


@pytest.mark.slow
def test_frames_of_pandas():
    pandas = pytest.importorskip("pandas")
    left = pandas.DataFrame({"t": [0.0, 1.0, 2.0, 3.0], "speed": [1.0, 1.0, 9.0, 1.0]})
    right = pandas.DataFrame({"t": [0.5, 1.5, 2.5, 3.5], "gear": [1, 2, 3, 4]})
    frame = left.merge(right, how="outer", on="t").sort_values("t")
    told_by = {one.name: one.remark for one in judged(base(), frame).health}
    assert 'nan="no update"' in told_by["speed"]
    assert told(base(), frame, nan="no update") == told(base(), frame.convert_dtypes())
    assert told(base(), frame.set_index("t")) == told(base(), frame)
    with pytest.raises(TraceError, match="column `t` appears twice"):
        judged(base(), pandas.concat([left, left], axis=1))


@each("stamps", ["t_ns", "t_ms", "t"])
def test_columns_of_one_array(stamps):
    """They are not contiguous in memory, as in data frames of one type."""
    one = np.array([[0, 1], [10, 2], [20, 9]])
    own, apart = (
        dict(zip((stamps, "speed"), rows.T, strict=True)) for rows in (one, one.copy("F"))
    )
    assert told(base(), own) == told(base(), apart)
