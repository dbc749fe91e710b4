"""Recordings in columns that lack a name do not pass."""

import json

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from tests.tools.each import each

import rvmon

SPEC = """
spec base "A base"
signal speed : real [m/s] input
signal gap : real [m] input
event pick(id : int) input
requirement R1 "It is slow"
  always speed <= 1 m/s
requirement R2 "It keeps away"
  always gap > 1 m
requirement R3 "What is picked is known"
  whenever pick and pick.id > 7
  then speed <= 1 m/s
"""
COLUMNS = {"t": [0.0, 1.0], "speed": [0.0, 2.0], "gap": [2.0, 2.0], "pick": [True, False]}


@pytest.fixture
def spec():
    return rvmon.loads(SPEC)


def doors(folder, columns):
    """The same recording in all formats with columns."""
    lines = [
        ",".join(columns),
        *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True)),
    ]
    (folder / "a.csv").write_text("\n".join(lines) + "\n")
    parquet.write_table(pyarrow.table(columns), folder / "a.parquet")
    arrays = {name: np.array(column) for name, column in columns.items()}
    return [folder / "a.csv", folder / "a.parquet", columns, arrays, pyarrow.table(columns)]


def without(name):
    return {own: column for own, column in COLUMNS.items() if own != name}


@pytest.mark.parametrize("value", ["x", "sum(x, 1 s)", "max(x, 2 s) + 1", "count(x > 1, 2 s)"])
def test_what_is_captured_is_read_by_the_requirement(value):
    spec = rvmon.loads(
        "time sampled\nsignal p : bool\nsignal x : real\nevent e\n"
        f"requirement R\n  upon e\n  let v = {value}\n  then p\n"
    )
    monitor = spec.monitor()
    monitor.step(0, {"e": True, "p": True})
    (missing,) = monitor.finish().health
    assert (missing.name, missing.kind, missing.requirements) == ("x", "missing", ("R",))


def test_updates_of_a_missing_name_are_unknown():
    """A missing column means neither that an event occurred nor that it did not."""
    conditions = ("not updated(beat) or p", "not updated(e) or p", "age(beat) <= 1 s")
    required = "".join(
        f"requirement R{n}\n  always ({one})\n"
        for n, one in enumerate((*conditions, "not changed(beat)"))
    )
    spec = rvmon.loads(f"signal p : bool\nsignal beat : real\nevent e\n{required}")
    columns = {"t": np.array([0.0, 1.0, 3.0]), "p": np.array([False, True, False])}
    report = spec.evaluate(columns, allow_missing=True)
    assert {*report.verdicts.values()} == {"I"}


def test_a_name_that_is_read_has_a_column(spec, tmp_path):
    for trace in doors(tmp_path, without("speed")):
        with pytest.raises(rvmon.errors.MissingNameError, match="`speed`, read by R1"):
            spec.evaluate(trace)
        for allowed in (True, ["speed"], {"speed": 1}):
            report = spec.evaluate(trace, allow_missing=allowed)
            assert (report.verdicts["R1"], report.verdicts["R2"]) == ("I", "P")
        with pytest.raises(rvmon.errors.MissingNameError):
            spec.evaluate(trace, allow_missing=["gap"])


def test_recordings_in_lines_declare_nothing(spec, tmp_path):
    """An event that never occurs is false there; a signal without values leaves attempts open."""
    path = tmp_path / "a.jsonl"
    path.write_text('{"t": 0, "gap": 2}\n{"t": 1, "gap": 2}\n')
    for trace in (path, [(0, {"gap": 2.0}), (1, {"gap": 2.0})]):
        assert spec.evaluate(trace).verdicts == {"R1": "I", "R2": "P", "R3": "NT"}


def test_an_event_is_there_by_a_column_of_its_payload(spec, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("t,speed,gap,pick.id\n0,0,2,\n1,2,2,8\n")
    assert spec.evaluate(path).verdicts == {"R1": "F", "R2": "P", "R3": "F"}


@each(
    "column",
    [
        *("Speed", "SPEED", "speed [m/s]", "speed(m/s)", "speed_mps", "speed_m_s", "/base/speed"),
        *("sped", "/base/Speed [m/s]", "base.speed", "/odom/twist/x"),
    ],
)
def test_the_column_that_was_meant_is_told(spec, column):
    table = {column if name == "speed" else name: cells for name, cells in COLUMNS.items()}
    table["other"] = [1, 2]
    with pytest.raises(rvmon.errors.MissingNameError) as error:
        spec.evaluate(table)
    assert f"did you mean `{column}`?" in str(error.value)
    mapped = spec.evaluate(table, columns={"speed": column})
    assert mapped.verdicts == spec.evaluate(COLUMNS).verdicts


def test_unknown_names_are_refused(spec):
    with pytest.raises(rvmon.RvmonError, match="did you mean `speed`"):
        spec.evaluate(COLUMNS, allow_missing=["sped"])
    with pytest.raises(rvmon.RvmonError, match="did you mean `speed`"):
        spec.evaluate(COLUMNS, columns={"sped": "v"})
    with pytest.raises(rvmon.RvmonError, match="one column, one name"):
        spec.evaluate(COLUMNS, columns={"speed": "v", "gap": "v"})
    with pytest.raises(rvmon.errors.MissingNameError, match=r"`speed` \(as `v_mean`\), read by R1"):
        spec.evaluate(COLUMNS, columns={"speed": "v_mean"})


def test_many_traces_are_read_alike(spec):
    renamed = {"at": [0, 1000], "v": [0.0, 2.0], "gap": [2.0, 2.0]}
    options = {"time": "at:ms", "columns": {"speed": "v"}, "allow_missing": ["pick"]}
    for jobs in (1, 2):
        [report] = spec.evaluate_many([renamed], jobs=jobs, **options)
        assert (report.verdicts["R1"], report.end) == ("F", 1_000_000_000)


def test_a_column_is_mapped_through_every_door(spec, tmp_path):
    columns = {**COLUMNS, "v": COLUMNS["speed"], "speed": [0.0, 0.0]}
    for trace in doors(tmp_path, columns):
        assert spec.evaluate(trace).verdicts["R1"] == "P"
        assert spec.evaluate(trace, columns={"speed": "v"}).verdicts["R1"] == "F"
    path = tmp_path / "a.jsonl"
    path.write_text('{"t": 0, "odom": {"v": 0}}\n{"t": 1, "odom": {"v": 2}, "speed": 0}\n')
    assert spec.evaluate(path, columns={"speed": "odom.v"}).verdicts["R1"] == "F"


@pytest.mark.slow
def test_the_command_line_refuses_and_maps(tmp_path, monkeypatch, says):
    """Exit code 2 with the file, 1 if the name may be missing, 0 if it is mapped."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.rv").write_text(SPEC)
    (tmp_path / "less.csv").write_text("t,Speed,gap,pick\n0,0,2,1\n1,0,2,0\n")
    run, why = ("run", "base.rv", "less.csv"), ("why", "base.rv", "less.csv", "R1")
    told = says(2, *run).err
    assert "error: less.csv: there is no column" in told
    assert "--map speed=Speed" in told
    assert "--allow-missing=speed" in told
    mapped = ("--map", "speed=Speed")
    says(0, *run, "--only", "R2")
    says(0, *run, *mapped, "--only", "R1,R2")
    says(1, "run", "--allow-missing", *run[1:], "--format", "json")
    shown = json.loads(says(1, *run, "--allow-missing=speed", "--format", "json").out)
    assert shown["requirements"]["R1"]["verdict"] == "I"
    says(2, *run, "--allow-missing=gap")
    says(2, *why)
    says(0, *why, *mapped)
    for wrong in ("speed", "=x", "speed="):
        assert "expected NAME=COLUMN" in says(2, *run, "--map", wrong).err
