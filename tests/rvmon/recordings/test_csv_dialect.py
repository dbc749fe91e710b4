"""CSV in the dialects of other tools gives the records of plain CSV."""

import random
from itertools import islice

import pytest
from tests.rvmon.recordings.test_csv_batch import read
from tests.tools.each import each

import rvmon
from rvmon.errors import TraceError
from rvmon.recordings import csv_dialect
from rvmon.recordings.csv_dialect import PLAIN, dialect_of

SPEC = """
spec base
signal speed : real [m/s]
signal mode : {idle, busy}
event stop

requirement R1
  always speed < 2 m/s
requirement R2
  upon stop
  then within 500 ms speed < 0.5 m/s
requirement R3
  always (mode == busy -> speed > 0.25 m/s)
"""


def rows_at_random(seed, count=60):
    rng = random.Random(seed)
    t, rows = 0, []
    for _ in range(count):
        t += rng.choice([1, 250_000, 1_003])
        speed = rng.choice(["", "0.125", "1.5", "2.5", "-1e-3", "nan"])
        rows.append((t * 1_000, speed, rng.choice(["", "idle", "busy"]), rng.choice(["", "1"])))
    return rows


NAMES = ("t_ns", "speed", "mode", "stop")


def written(rows, sign=",", *, names=NAMES, point=".", end="\n", above=(), within=()):
    """Rows in a dialect: other separators, names with units, lines above and between rows."""
    lines = [sign.join(names)]
    for t, *cells in rows:
        stamp = f"{t // 10**9}.{t % 10**9:09d}" if names[0] == "t" else t
        stamp = t // 1_000 if "us" in names[0] else stamp
        lines.append(sign.join(str(one).replace(".", point) for one in (stamp, *cells)))
    return end.join([*above, *lines[:10], *within, *lines[10:], ""])


OF_EUROPE = {"sign": ";", "point": ",", "names": ("t", *NAMES[1:])}
DIALECTS = {
    "semicolons": OF_EUROPE,
    "said": OF_EUROPE | {"above": ["sep=;"]},
    "tabs": {"sign": "\t", "end": "\r\n", "names": ("t", *NAMES[1:])},
    "bars below remarks": {
        "sign": "|",
        "above": ["# Logger 3", "# rate: 100 Hz; range: 2"],
        "within": ["# paused"],
    },
    "below properties": {"above": ["Device:,Base 7", "Serial;4711"]},
    "units in names": {"names": ("t [us]", "speed [m/s]", "mode", "stop (-)")},
}


@pytest.mark.slow
@pytest.mark.parametrize("dialect", DIALECTS.values(), ids=DIALECTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_dialect_gives_the_records_that_plain_csv_gives(tmp_path, dialect, encoding):
    spec, verdicts = rvmon.loads(SPEC), set()
    for seed in range(2):
        rows = rows_at_random(seed)
        (tmp_path / "plain.csv").write_text(written(rows))
        (tmp_path / "other.csv").write_bytes(written(rows, **dialect).encode(encoding))
        expected, found = (spec.evaluate(tmp_path / name) for name in ("plain.csv", "other.csv"))
        assert found.attempts == expected.attempts
        assert (found.verdicts, found.end) == (expected.verdicts, expected.end)
        verdicts |= {str(attempt.verdict) for attempt in found.attempts}
    assert {"P", "F"} <= verdicts


def test_plain_text_is_left_as_it_is(tmp_path):
    for seed in range(8):
        assert dialect_of(written(rows_at_random(seed)).encode()) == PLAIN
    for text in ("", "t", "t,a\n", "t,a\n1\n", 't,"a;b"\n0,1;5\n', "1,2\n3,4\n", "a b c\n"):
        assert dialect_of(text.encode()) == PLAIN or text == "a b c\n"


def test_blanks_in_a_property_and_in_labels_separate_nothing(tmp_path):
    spec = rvmon.loads("spec s\nsignal n : int\nrequirement R\n always n == 0")
    rows = "".join(f"{t},idle now,1\n" for t in range(20))
    (tmp_path / "a.csv").write_text(f"Device,Base 7\nSerial,4711\n\nt,mode,n\n{rows}")
    assert spec.evaluate(tmp_path / "a.csv").verdicts["R"] == "F"


def test_blanks_and_a_header_that_is_a_comment(tmp_path):
    """As written by `numpy.savetxt` and by trajectory recorders."""
    spec = rvmon.loads("spec s\nsignal x, y : real\nrequirement R\n always x + y < 5")
    (tmp_path / "a.csv").write_text("# t x y\n0 1 2\n0.5  2   2.5\n1 3 4\n")
    assert spec.evaluate(tmp_path / "a.csv").attempts[0].decided == 10**9
    text = written([(t, x or "nan") for t, x, *_ in rows_at_random(1)], names=NAMES[:2])
    (tmp_path / "b.csv").write_text(f"# {text}")
    (tmp_path / "c.csv").write_text(text)
    spec = rvmon.loads("spec s\nsignal speed : real\nrequirement R\n always speed < 2")
    assert spec.evaluate(tmp_path / "b.csv").attempts == spec.evaluate(tmp_path / "c.csv").attempts


@each(
    ("header", "cells", "time"),
    [
        ("secs,nsecs", "1700000001,500000000", "secs+nsecs"),
        ("header.stamp.sec,header.stamp.nanosec", "1700000001,500000000", ""),
        ("s,usec", "1700000001,500000", "s+usec"),
        ("Date,Time", "14.11.2023,22:13:21.5", "Date+Time:%d.%m.%Y %H:%M:%S.%f"),
        ("when", "11/14/23 10:13:21.5 PM", "when:%m/%d/%y %I:%M:%S.%f %p"),
        ("when", "2023-11-14 22:13:21.500", "when:iso"),
    ],
)
def test_stamps_of_two_columns_and_dates(tmp_path, header, cells, time):
    (tmp_path / "a.csv").write_text(f"{header},speed\n{cells},0.5\n")
    time = time or "header.stamp.sec+header.stamp.nanosec"
    spec = rvmon.loads("spec s\nsignal speed : real\nrequirement R\n always speed < 2")
    assert spec.evaluate(tmp_path / "a.csv", time=time).end == 1_700_000_001_500_000_000


def test_faults_are_told_with_the_line_that_they_are_on(tmp_path):
    spec = rvmon.loads("spec s\nsignal speed : real\nrequirement R\n always speed < 2")
    path = tmp_path / "a.csv"
    for text, told, time in (
        ("# a\n# b\nt;speed\n0;1,5\n1;x\n", r"a\.csv: line 5: column `speed`", None),
        ("t;speed\n0;1,5\n1;2;3\n", r"a\.csv: line 3: 3 cells where the header has 2", None),
        ("s,ns,speed\n1,2,3\n1,x,3\n", r"line 3: time `1 x` is not two whole numbers", "s+ns"),
        ("d,speed\n1,2\n", r"line 2: time `1` is not a date like `%Y`", "d:%Y"),
        ("s,speed\n1,2\n", r"no time column `s\+ns`", "s+ns"),
    ):
        path.write_text(text)
        with pytest.raises(TraceError, match=told):
            spec.evaluate(path, time=time)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_within_a_cell_keep_their_numbers(end, tmp_path):
    spec = rvmon.loads(SPEC)
    rows = [f"{t};;{t / 4}" for t in range(10)]
    rows += [*(f'{t};"one{end}two{end}{end}three";1' for t in range(10, 14)), "14;;x"]
    path = tmp_path / "a.csv"
    path.write_bytes("\n".join(["t;note;speed", *rows, ""]).encode())
    samples = iter(spec.recording(path))
    assert len(list(islice(samples, 13))) == 13
    with pytest.raises(TraceError, match="line 28: column `speed`: `x`"):
        list(samples)


def test_a_unit_in_a_name_is_compared(tmp_path):
    spec = rvmon.loads(SPEC)
    path = tmp_path / "a.csv"
    path.write_text("t,speed [km/h],mode,stop\n0,1,idle,\n")
    with pytest.raises(TraceError, match=r"`speed \[km/h\]` is in \[km/h\], and `speed` is"):
        spec.evaluate(path)
    path.write_text("t,V (rad),mode,stop\n0,1,idle,\n")
    with pytest.raises(TraceError, match=r"`V \(rad\)` is in \[rad\], and `speed` is declared"):
        spec.evaluate(path, columns={"speed": "V (rad)"})
    path.write_text("t,speed,speed [km/h],mode,stop\n0,1,9,idle,\n")
    assert spec.evaluate(path).end == 0


def test_an_unknown_unit_in_a_name_is_not_taken_for_the_declared_one(tmp_path):
    spec = rvmon.loads(SPEC)
    path = tmp_path / "a.csv"
    path.write_text("t,speed [kmh],mode,stop\n0,1,idle,\n")
    with pytest.raises(TraceError, match=r"`kmh` is not a known unit.*--map 'speed=speed \[kmh"):
        spec.evaluate(path)
    assert spec.evaluate(path, columns={"speed": "speed [kmh]"}).end == 0


@pytest.mark.parametrize("seed", range(40))
def test_lines_that_are_taken_together_say_the_same(seed, tmp_path, monkeypatch):
    rng = random.Random(seed)
    remark = rng.choice(["", "# by a tool\n"])
    lines = [f"{remark}t;speed;mode;stop\n"]
    odd = ['{};"1,5";busy;\n', "{};1,5;b,usy;\n", "\n", ";;;\n", "# {}\n", "{};x;;\n", "{};1,5;\n"]
    odd += [' ; "";;\n', '"{}";"-1,5";" busy ";"1"\n', '{};"1,\n5";busy;1\n']
    for t in range(60):
        line = rng.choice(odd) if rng.random() < 0.03 else "{},5;-{},25;idle;1\r\n"
        lines.append(line.format(t, t))
    path = tmp_path / "a.csv"
    path.write_text("".join(lines)[: rng.choice([None, -2])], newline="")
    found = []
    for together in (0, 1, 7, 4096):
        monkeypatch.setattr(csv_dialect, "_TOGETHER", together)
        found.append(read(rvmon.loads(SPEC).recording(path)))
    assert found == [found[0]] * 4
