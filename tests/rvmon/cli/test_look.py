"""`rvmon look` shows every name of a recording over time, as text and as a page."""

import math
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.tools.each import each
from tests.tools.logs import write_ulog

SPEC = """
spec base
signal speed : real [m/s]
signal never : bool
event stop

requirement R1 "Slow"
  always speed < 3 m/s
requirement R2 "Stops"
  upon stop
  then within 1 s (speed < 1 m/s or never)
"""


@pytest.fixture
def recording(tmp_path):
    rows = ["t,speed [m/s],mode,armed,limit,stop"]
    for tick in range(400):
        speed = f"{2 + math.sin(tick / 40):.3f}" if not 100 <= tick < 200 else ""
        mode = "idle" if tick < 250 else "busy"
        rows.append(f"{tick / 10},{speed},{mode},{tick % 2},7,{int(tick in (20, 300))}")
    (tmp_path / "base.csv").write_text("\n".join([*rows, ""]))
    (tmp_path / "base.rv").write_text(SPEC)
    return tmp_path


def test_each_name_has_its_kind_rate_gap_and_values(recording, says):
    told = says(0, "look", recording / "base.csv").out
    lines = {line.split()[0]: line for line in told.splitlines() if line.split()}
    assert "400 samples in 39.9 s" in " ".join(told.split())
    assert "real [m/s]" in lines["speed"]
    assert "gap 10.1 s" in lines["speed"]
    assert "idle, busy" in lines["mode"]
    assert "false and true" in lines["armed"]
    assert "always 7" in lines["limit"]
    assert "2 times" in lines["stop"]
    drawn = lines["speed"].split("s", 3)[-1]
    assert "█" in drawn
    assert "  " in drawn.strip()


def test_with_a_specification_names_stand_below_their_requirements(recording, says):
    told = says(0, "look", recording / "base.csv", recording / "base.rv").out
    assert told.index("R1  Slow") < told.index("real [m/s]") < told.index("R2  Stops")
    assert "left out: never: nothing feeds it" in told
    [line] = [line for line in told.splitlines() if line.split()[:1] == ["stop"]]
    assert "2 times" in line  # a cell of 0 is no occurrence


def test_a_page_shows_each_name_and_escapes_markup(recording, says):
    path, page = recording / "base.csv", recording / "look.html"
    path.write_text(path.read_text().replace("mode", "<b>mode"))
    assert "wrote" in "".join(says(0, "look", path, "-o", page))
    text = page.read_text()
    assert "&lt;b&gt;mode" in text
    assert "<b>mode" not in text
    assert text.count('class="course"') >= 3  # `speed` is drawn in two parts
    assert text.count('class="event"') == 2


def test_lost_data_of_a_log_is_reported_and_shaded(tmp_path, says):
    pytest.importorskip("pyulog")
    rows = [(t, t / 1e6, 0) for t in range(1_000_000, 1_300_000, 1_000)]
    path = write_ulog(tmp_path / "a.ulg", rows, drops=[(100, 30)])
    assert "lost: everything from 0.1 s (stamp 1.1 s) on:" in says(0, "look", path).out
    says(0, "look", path, "-o", tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert 'class="lost"' in page
    assert '<code title="drive.speed">speed</code>' in page  # below the heading of its topic


def test_a_name_is_drawn_only_until_it_falls_silent(put, says):
    rows = [f"{k / 100},{k % 7}," for k in range(100)] + [f"{1 + k},,{k}" for k in range(200)]
    put("a.csv", "\n".join(["t,early,late", *rows, ""]))
    early, late = says(0, "look", "a.csv").out.splitlines()[1:3]
    assert [sum(sign in "▁▂▃▄▅▆▇█" for sign in line) for line in (early, late)] == [1, 20]
    says(0, "look", "a.csv", "-o", "a.html")
    text = Path("a.html").read_text()
    marks = re.findall(r'<span style="left:([\d.]+)%">([^<]*)<', text)
    assert marks == [("0.00", "0 s"), ("25.00", "50 s"), ("50.00", "100 s"), ("75.00", "150 s")]
    curves = re.findall(r' d="M(.*?)Z', text)
    ends = [max(map(float, re.findall(r"([\d.]+) [\d.]+", curve))) for curve in curves]
    width = float(re.search(r'viewBox="0 0 ([\d.]+) ', text)[1])
    assert [round(end / width, 1) for end in ends] == [0.0, 1.0]


@each("most", [1.7e308, 5e-324])
def test_numbers_of_any_size_are_drawn(most, put, says):
    rows = f'{{"t": 0, "x": {most}}}\n{{"t": 1, "x": {-most}}}\n{{"t": 2, "x": 0.0}}\n'
    assert says(0, "look", put("sizes.jsonl", rows)).out.split()[-3:] == ["█", "▁", "▅"]
    says(0, "look", "sizes.jsonl", "-o", "sizes.html")
    (curve,) = re.findall(r'd="M([^"]+)Z', Path("sizes.html").read_text())
    assert {point.split()[1] for point in curve.split("L")} == {"3.0", "20.0", "37.0"}


@pytest.mark.slow
@pytest.mark.parametrize("odd", ["word", "1" * 100_000 + "x", "1.5\n2.5"])
def test_the_kind_of_a_column_depends_on_its_last_cell_too(odd, put, says):
    rows = "".join(f"{t},{t / 7},{t % 3}\n" for t in range(20_000))
    told = says(0, "look", put("long.csv", f't,x,n\n{rows}20000,"{odd}",1\n')).out
    assert "x: numbers and text" in " ".join(told.split())
    assert "0 … 2" in told


@each(
    ("values", "code", "told"),
    [
        # `null` is no label.
        (['"blue"', "null", '"red"'], 0, "x label blue, red"),
        (["null"], 2, "`x`: no value in the recording"),
        # An integer of more than 64 bits is read as a double.
        ([2**63 + 5] * 3, 0, "x real always 9.22337204e+18"),
        ([10**400], 2, "a.jsonl: line 1: field `x`"),
    ],
)
def test_a_name_is_described_by_its_values(values, code, told, put, says):
    path = put("a.jsonl", "".join(f'{{"t": {t}, "x": {x}}}\n' for t, x in enumerate(values)))
    assert told in " ".join("".join(says(code, "look", path)).split())


def test_unsigned_64_bit_numbers_are_shown(tmp_path, says):
    """No signal of a specification can have such values."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["log/t"] = np.arange(2.0)
        file["log/id"] = np.array([2**63 + 5, 2**64 - 1], np.uint64)
    shown = " ".join(says(0, "look", tmp_path / "a.h5").out.split())
    shown = re.sub(r"…[^0-9]*1 Hz[^0-9]*", "… ", shown)
    assert "9223372036854775808 … 18446744073709551616" in shown


def test_the_index_of_a_data_frame_is_left_out_in_silence(tmp_path, says):
    path = tmp_path / "a.csv"
    path.write_text(",t,x\n0,0,1\n1,1,2\n")
    told = says(0, "look", path).out
    assert "x" in told
    assert "left out" not in told
