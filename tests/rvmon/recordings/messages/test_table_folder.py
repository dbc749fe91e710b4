"""A folder of tables is one recording, joined by time; each file has its own missing names."""

import gzip
import math

import pytest

import rvmon
from rvmon.cli import main
from rvmon.errors import RvmonError
from rvmon.recordings.recording import FileRecording

SPEC = """
spec flight
signal pose.x, speed : real
signal pose.q : real
signal battery.armed : bool
signal battery.count : int
signal mode : {idle, fly}

requirement R1
  always (pose.x < 3 or speed < 0.9)
requirement R2
  upon mode == fly
  then within 2 s (battery.armed and speed > 0.1)
requirement R3
  always (battery.count >= 0 -> known(speed))
"""

ONE = "spec s\nsignal speed : real\nrequirement R1\n  always speed < 1\n"


def folder(path, files, topics=""):
    path.mkdir()
    for name, text in files.items():
        (path / name).write_text(text)
    (path / "topics.toml").write_text(topics)
    return path


def samples(path, **columns):
    schema = rvmon.loads(SPEC).reading(columns=columns).schema
    return [(one.t, dict(one.values)) for one in FileRecording(path, schema) if one.values]


def test_each_file_says_what_it_says_at_its_own_instants(tmp_path):
    place = folder(
        tmp_path / "a",
        {
            "pose.csv": "t,x,q[0],q[1],Odd name\n0,1,,,7\n1,2,0.5,\n",
            "speed.csv": "t,speed\n0.5,0.25\n1,nan\n",
            "battery.csv": "t,armed,count\n1,0,3\n1.5,true,\n",
            "mode.csv": "t,mode\n2,fly\n",
        },
    )
    with pytest.raises(rvmon.TraceError, match=r"pose.csv: line 3: 4 cells, and the header has 5"):
        samples(place)
    (place / "pose.csv").write_text("t,x,q[0],q[1],Odd name\n0,1,,,7\n1,2,0.5,,\n")
    found = samples(place, **{"pose.q": "/pose.q[0]"})
    assert found[:2] == [(0, {"pose.x": 1.0}), (5 * 10**8, {"speed": 0.25})]
    assert found[2][0] == 10**9
    assert math.isnan(found[2][1].pop("speed"))
    assert found[2][1] == {
        "pose.x": 2.0,
        "pose.q": 0.5,
        "battery.armed": False,
        "battery.count": 3,
    }
    assert found[3:] == [(15 * 10**8, {"battery.armed": True}), (2 * 10**9, {"mode": "fly"})]


def test_a_file_says_which_is_which(tmp_path, says):
    toml = (
        'time = "stamp:us"\n[topics]\nspeed = "log_speed_0.csv"\n'
        'mode = {file = "mode.csv.gz", time = "t"}\n'
        'pose = {file = "pose.csv", type = "geometry_msgs/msg/Point"}\n'
    )
    files = {
        "log_speed_0.csv": "stamp,speed\n1000000,0.5\n",
        "pose.csv": "stamp,x\n3000000,1\n",
        "other.csv": "no table\n",
    }
    place = folder(tmp_path / "a", files, toml)
    (place / "mode.csv.gz").write_bytes(gzip.compress(b"t,mode\n2,idle\n"))
    assert samples(place) == [
        (10**9, {"speed": 0.5}),
        (2 * 10**9, {"mode": "idle"}),
        (3 * 10**9, {"pose.x": 1.0}),
    ]
    spec = tmp_path / "a.rv"
    spec.write_text("spec s\nsignal pose.x : real [m/s]\nrequirement R\n  always pose.x < 2 m/s\n")
    assert "`pose.x` is declared [m/s], and `x` of topic /pose" in says(2, "run", spec, place).err
    spec.write_text(ONE + "signal height : real [m]\n")
    assert '[bind.speed]  # real\ntopic = "/speed"' in says(1, "init", place, "--for", spec).out


@pytest.mark.parametrize("rows", ["0,0\n1,1\n2,0\n", "0,\n" * 1001 + "1,1\n2,0\n"])
def test_a_0_is_not_an_occurrence_of_an_event(tmp_path, rows, says):
    """As in a single file; the declaration decides if 1 is a number or true."""
    place = folder(tmp_path / "a", {"stop.csv": "t,stop\n" + rows})
    spec = rvmon.loads("event stop\nrequirement R\n  upon stop\n  then always not stop\n")
    [attempt] = spec.evaluate(place / "stop.csv").attempts
    assert spec.evaluate(place).attempts == (attempt,)
    assert attempt.triggered == 10**9
    spec = rvmon.loads("signal stop : int\nrequirement R\n  always stop < 2\n")
    assert spec.evaluate(place).verdicts["R"] == "P"
    (tmp_path / "a.rv").write_text("event stop\nrequirement R\n  always not stop\n")
    told = says(0, "init", place, "--for", tmp_path / "a.rv").out
    assert 'value = "stop"' in told.partition("[bind.stop]")[2]


def test_of_a_topic_that_cannot_be_read_nothing_is_proposed(tmp_path, says):
    place = folder(tmp_path / "a", {"stop.csv": "t,stop,stop.by\n0,true,1\n"})
    (tmp_path / "a.rv").write_text("event stop\nrequirement R\n  always not stop\n")
    assert "`stop` is left open" in says(1, "init", place, "--for", tmp_path / "a.rv").err


@pytest.mark.parametrize(
    ("files", "toml", "message"),
    [
        ({}, "", "there is no table: put .csv files"),
        ({"a.csv": "t,x\n0,1\n"}, "time = ", "topics.toml: no TOML"),
        ({"a.csv": "t,x\n0,1\n"}, "tme = 3", "topics.toml: no key `tme`: did you mean `time`"),
        ({"a.csv": "t,x\n0,1\n"}, "[topics]\na = 3", "which file is `a`"),
        ({"ab.csv": "t,x\n0,1\n"}, '[topics]\na = "abc.csv"', r"abc\.csv: No such file .*ab\.csv`"),
        ({"speed.csv": "time,x\n0,1\n"}, "", r"speed\.csv: expected one time column"),
        ({"speed.csv": "t,speed\n1,1\n0,1\n"}, "", r"speed\.csv: line 3: time goes backwards"),
        ({"speed.csv": "t,speed\nzero,1\n"}, "", r"speed\.csv: line 2: "),
        ({"speed.csv": "t,speed\n0,1e400\n"}, "", r"speed\.csv: `1e400` is too large"),
        ({"speed.csv": "t,speed\n0,1\n1,fast\n"}, "", "`speed` is declared real, .* holds text"),
        ({"pose.csv": "t,x,x.y\n0,1,2\n"}, "", "topic /pose .* `x.y` is in `x`: rename one"),
        ({"pose.csv": "t,x,q[0],q\n0,1,2,3\n"}, "", r"topic /pose .* `q\[0\]` is in `q`"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, files, toml, message):
    place = folder(tmp_path / "a", files, toml)
    with pytest.raises(RvmonError, match=message):
        rvmon.loads(SPEC).evaluate(place, allow_missing=True)


@pytest.mark.slow
def test_commands_take_such_a_folder_for_one_recording(tmp_path, monkeypatch, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.rv").write_text(ONE)
    (tmp_path / "runs").mkdir()
    for name, speed in (("one", 0.5), ("two", 2)):
        folder(tmp_path / "runs" / name, {"speed.csv": f"t,speed\n0,{speed}\n1,0\n"})
    shown = says(1, "run", "s.rv", "runs").out
    assert "runs/one  to 1 s" in shown
    assert "runs/two  to 1 s" in shown
    assert main(["why", "s.rv", "runs/two", "R1"]) == 0
    assert main(["run", "s.rv", "runs", "--out", "out.csv", "--resume"]) == 1
    assert main(["init", "runs/one"]) == 0
    says(0, "run", "one.rv", "runs/one", "--strict")
    clip = ["clip", "s.rv", "runs/two", "R1#1", "--before", "1s", "-o", "x"]
    assert "clip each of them" in says(2, *clip).err


def test_a_file_of_a_topic_whose_last_line_has_no_end_is_refused(tmp_path):
    """Its last cell may be incomplete."""
    files = {"speed.csv": "t,speed\n0,0.5\n1,0.9"}
    with pytest.raises(RvmonError, match=r"speed\.csv: line 3: it has no end: was it cut off"):
        rvmon.loads(ONE).evaluate(folder(tmp_path / "a", files))
