"""Several files or tables of one log, joined by time; each has its own missing names."""

import random

import pytest

import rvmon
from rvmon.cli import main
from rvmon.errors import MissingNameError
from rvmon.recordings import places

pytestmark = pytest.mark.slow

SPEC = """
spec flight
signal speed : real  stale after 700 ms
signal status.armed : bool
signal mode : {idle, fly}
event stop
requirement R1
  always (status.armed -> speed < 0.9)
requirement R2
  upon mode == fly
  then within 1 s (status.armed and speed > 0.1)
requirement R3
  upon stop
  then within 500 ms updated(speed)
"""

COLUMNS = {
    "speed": ("log_7_odom_0", lambda rng: f"{rng.random():.3f}"),
    "status.armed": ("log_7_status_0", lambda rng: rng.choice(["true", "false", "nan"])),
    "mode": ("log_7_mode_0", lambda rng: rng.choice(["idle", "fly"])),
    "stop": ("log_7_mode_0", lambda rng: rng.choice(["true", "false"])),
}


def written(folder, rng, most=40):
    """A log as a file per topic, and as one file with empty cells."""
    files, whole = {}, []
    for topic in dict.fromkeys(topic for topic, _ in COLUMNS.values()):
        names = [name for name, (own, _) in COLUMNS.items() if own == topic]
        lines = [",".join(["t", *(name.removeprefix("status.") for name in names)])]
        draw = rng.sample if rng.random() < 0.7 else rng.choices  # with repeated instants
        for step in sorted(draw(range(most), k=rng.randint(0, most // 2))):
            cells = {name: COLUMNS[name][1](rng) if rng.random() < 0.9 else "" for name in names}
            lines.append(",".join([f"{step / 10}", *cells.values()]))
            whole.append((step, cells))
        files[topic] = folder / f"{topic}.csv"
        files[topic].write_text("\n".join(lines) + "\n")
    rows = [
        ",".join([f"{step / 10}", *(cells.get(name, "") for name in COLUMNS)])
        for step, cells in sorted(whole, key=lambda one: one[0])
    ]
    (folder / "whole.txt.csv").write_text("\n".join([",".join(["t", *COLUMNS]), *rows]) + "\n")
    return [str(path) for path in files.values()], str(folder / "whole.txt.csv"), len(whole)


def attempts(report):
    return [(one.name, one.verdict, one.triggered, one.decided) for one in report.attempts]


@pytest.mark.law
def test_joined_files_give_what_one_file_with_empty_cells_gives(tmp_path, monkeypatch):
    """No value of one file is carried into rows of another, row by row or in blocks."""
    for seed in range(12):
        rng = random.Random(seed)
        monkeypatch.setattr(places, "BLOCK", rng.choice([300, 3_000, 1 << 20]))
        files, whole, count = written(tmp_path, rng, 40 if seed < 8 else 1_500)
        if not count:
            continue
        spec = rvmon.loads(SPEC)
        joined, one = spec.evaluate(files), spec.evaluate(whole)
        assert attempts(joined) == attempts(one)
        assert joined.health == one.health
        late = rvmon.loads("max delay 1 ms\n" + SPEC)
        assert attempts(late.evaluate(files)) == attempts(late.evaluate(whole))


def test_late_rows_of_a_file_are_put_in_order_under_max_delay(tmp_path):
    text = "signal x, y : real\nrequirement R\n  always x <= y\n"
    (tmp_path / "a.csv").write_text("t,x\n0,1\n0.3,3\n0.2,2\n1,4\n")
    (tmp_path / "b.csv").write_text("t,y\n0,1\n0.2,2\n0.1,5\n0.3,3\n0.9,9\n")
    (tmp_path / "c.csv").write_text("t,x,y\n0,1,1\n0.1,,5\n0.2,2,2\n0.3,3,3\n0.9,,9\n1,4,\n")
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    late = rvmon.loads("max delay 200 ms\n" + text).evaluate(files)
    assert late.verdicts["R"].value == "P"
    assert attempts(late) == attempts(rvmon.loads(text).evaluate(tmp_path / "c.csv"))
    with pytest.raises(rvmon.TraceError, match=r"a\.csv: line 4: time goes backwards"):
        rvmon.loads(text).evaluate(files)


def test_a_file_says_where_its_error_is(tmp_path, capsys, says):
    (tmp_path / "a.csv").write_text("t,speed\n0,1\n1,x\n")
    (tmp_path / "b.csv").write_text("t,mode\n0,idle\n")
    (tmp_path / "s.rv").write_text("signal speed : real\nrequirement R\n  always speed < 9\n")
    assert main(["run", str(tmp_path / "s.rv"), str(tmp_path), "--join"]) == 2
    assert f"{tmp_path / 'a.csv'}: line 3: column `speed`: `x` is not" in capsys.readouterr().err
    (tmp_path / "a.csv").write_text("t,speed\n0,1\n")
    words = ["run", str(tmp_path / "s.rv"), str(tmp_path), "--join", "--report"]
    assert says(0, *words, tmp_path / "pages").out.startswith(f"{tmp_path} + ")


def test_a_name_of_two_files_is_asked_for(tmp_path):
    for name, speed in (("run_left", 1), ("run_right", 3)):
        (tmp_path / f"{name}.csv").write_text(f"t,speed\n0,{speed}\n")
    files = [str(tmp_path / "run_left.csv"), str(tmp_path / "run_right.csv")]
    bare = rvmon.loads("signal speed : real\nrequirement R\n  always speed < 2\n")
    with pytest.raises(rvmon.TraceError, match=r"`speed` is in .*left\.csv and in .*right\.csv"):
        bare.evaluate(files)
    assert bare.evaluate(files, columns={"speed": "left.speed"}).verdicts["R"].value == "P"
    assert bare.evaluate(files, columns={"speed": "run_right.speed"}).verdicts["R"].value == "F"
    both = "signal left.speed, run_right.speed : real\nrequirement R\n  "
    spec = rvmon.loads(f"{both}always left.speed < run_right.speed\n")
    assert spec.evaluate(files).verdicts["R"].value == "P"


def test_a_name_that_no_file_has_is_missing(tmp_path):
    """A file with a header only has its names, without values."""
    (tmp_path / "a.csv").write_text("t,speed\n0,1\n")
    (tmp_path / "b.csv").write_text("t,mode\n")
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    with pytest.raises(MissingNameError, match=r"`status\.armed`, read by R1, R2"):
        rvmon.loads(SPEC).evaluate(files)
    text = "signal speed : real\nsignal mode : {idle}\nrequirement R\n  always mode == idle\n"
    assert rvmon.loads(text).evaluate(files).verdicts["R"].value == "I"
    with pytest.raises(rvmon.TraceError, match="holds no sample"):
        rvmon.loads(text.replace("speed", "x")).evaluate([tmp_path / "b.csv"])


def test_files_of_several_formats_are_joined(tmp_path):
    """JSON lines do not declare names, so an event without a line did not occur."""
    (tmp_path / "a.csv").write_text("stamp,speed\n0,1\n2000,3\n")
    (tmp_path / "b.jsonl").write_text('{"stamp": 1000, "stop": true}\n')
    spec = rvmon.loads(
        "signal speed : real\nevent stop\nrequirement R\n  upon stop\n  then within 1 s speed > 2\n"
    ).reading(time="stamp:ms")
    report = spec.evaluate([tmp_path / "a.csv", tmp_path / "b.jsonl"])
    assert attempts(report) == [("R#1", rvmon.Verdict.PASS, 10**9, 2 * 10**9)]


def test_tables_in_memory_are_joined():
    pandas = pytest.importorskip("pandas")
    spec = rvmon.loads(
        "signal speed : real\nsignal armed : bool\nrequirement R\n  always (armed -> speed < 1)\n"
    )
    speed = pandas.DataFrame({"t": [0.0, 1.0, 2.0], "speed": [0.5, 0.6, 0.7]})
    armed = {"t": [0.0, 1.5], "armed": [True, True]}
    assert spec.evaluate([speed, armed]).verdicts["R"].value == "P"
    merged = speed.merge(pandas.DataFrame(armed), on="t", how="outer")
    assert spec.evaluate(merged).verdicts["R"].value == "I"
    assert spec.evaluate(merged, nan="no update").verdicts["R"].value == "P"


@pytest.fixture
def both(tmp_path, monkeypatch):
    """Two files in a folder with a specification."""
    monkeypatch.chdir(tmp_path)
    for name in "ab":
        (tmp_path / f"{name}.csv").write_text(f"t,{name}\n0,1\n")
    (tmp_path / "s.rv").write_text("signal a, b : real\nrequirement R\n  always a <= b\n")
    return "a.csv + b.csv"


def test_no_piece_is_cut_out_of_several_files(both, says):
    clip = ["clip", "s.rv", both]
    for words, told in (
        ([*clip, "--from", "0", "--to", "1", "-o", "c.csv"], "clip each of them, by --from"),
        ([*clip, "R#1", "--reproducer", "c.rvcase"], "clip each of them, by --from"),
        (["init", both, "--for", "s.rv"], "bindings are proposed for one file at a time"),
    ):
        assert told in says(2, *words).err


def test_evidence_of_several_files_is_of_all_of_them(tmp_path, both, says):
    says(0, "run", "s.rv", "a.csv", "b.csv", "--join", "--evidence", "e.zip")
    assert "evaluated again: 1 of 1" in says(0, "evidence", "e.zip").out
    (tmp_path / "b.csv").write_text("t,b\n0,2\n")
    assert f"{both} is not the recording that was evaluated" in says(1, "evidence", "e.zip").out


def test_a_specification_is_begun_from_several_files(tmp_path):
    (tmp_path / "log_odom_0.csv").write_text("t,speed,mode\n0,1.5,fly\n1,2.5,idle\n")
    (tmp_path / "log_status_0.csv").write_text("t,armed,mode\n0,true,x\n2,false,y\n")
    both = f"{tmp_path / 'log_odom_0.csv'} + {tmp_path / 'log_status_0.csv'}"
    made = tmp_path / "made.rv"
    assert main(["init", both, "-o", str(made)]) == 0
    assert all(name in made.read_text() for name in ("speed", "armed", "odom.mode", "status.mode"))
    assert main(["run", str(made), both]) == 0
    assert main(["look", both, str(made)]) == 0
