"""Verdicts as MCAP, read back with the MCAP library, and the Foxglove layout."""

import json
import math
import re
from collections import defaultdict

import pytest
from tests.tools.bags import START, write_ros1

import rvmon
from rvmon.cli import main
from rvmon.report.foxglove_layout import scene_updates
from rvmon.report.tracks import Outline, Scene

pytest.importorskip("mcap")

SPEC = """
spec base "A base"
signal speed      : real [m/s]
signal arm.ready  : bool
event  pick(id: int)
requirement R1 "Picks are answered"
  upon pick
  then within 1 s `arm.ready`
requirement R2
  always speed < 2 m/s
requirement R3
  upon pick and speed > 5 m/s
  then speed < 1 m/s
""".replace("`", "")
ROWS = """t,speed,arm.ready,pick.id
0,0.5,0,
1,nan,,7
1.5,,1,
3,1.5,0,8
4,2.5,,
6,inf,,
6.5,1,,9
7,,,
"""


@pytest.fixture
def base(tmp_path, monkeypatch):
    """A folder with a specification and a recording."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text(ROWS)
    return tmp_path


def read_back(path):
    """Stamps and messages by topic, in the order of the file."""
    from mcap.reader import make_reader

    found, kinds, last = defaultdict(list), {}, 0
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages(log_time_order=False):
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            assert message.log_time >= last
            last = message.log_time
            kinds[channel.topic] = schema.name, json.loads(schema.data)["properties"]
            found[channel.topic].append((message.log_time / 1e9, json.loads(message.data)))
    for topic, entries in found.items():
        for _, content in entries:
            assert content.keys() <= kinds[topic][1].keys(), topic
    return found, kinds


def test_states_attempts_and_values_come_back(base):
    assert main(["run", "base.rv", "a.csv", "--mcap", "v.mcap", "--quiet"]) == 1
    found, kinds = read_back(base / "v.mcap")
    states = [(t, one["state"]) for t, one in found["/rvmon/requirements/R1"]]
    begun = [(0, "NT"), (1, "open"), (1.5, "P"), (3, "open"), (4.000000001, "F")]
    assert states == [*begun, (6.5, "open"), (7, "I")]
    assert found["/rvmon/requirements/R1"][-1][1] | {"state": ""} == {
        "state": "",
        "open": 0,
        "passed": 1,
        "failed": 1,
        "undecided": 1,
    }
    assert next(one["state"] for _, one in found["/rvmon/requirements/R3"]) == "NT"
    report = rvmon.load("base.rv").evaluate("a.csv")
    told = {one["name"]: (t, one) for t, one in found["/rvmon/attempts"]}
    assert kinds["/rvmon/attempts"][0] == "foxglove.Log"
    assert told.keys() == {one.name for one in report.attempts}
    for one in report.attempts:
        t, entry = told[one.name]
        assert t == (report.end if one.decided is None else one.decided) / 1e9
        assert (entry["verdict"], entry["reason"]) == (one.verdict, one.reason)
        assert entry["level"] == {"P": 2, "I": 3, "F": 4}[one.verdict]
        assert entry["timestamp"]["sec"] == int(t)
    assert found["/rvmon/signals/speed"] == [
        (0, {"known": True, "value": 0.5}),
        (1, {"known": False}),
        (3, {"known": True, "value": 1.5}),
        (4, {"known": True, "value": 2.5}),
        (6, {"known": True}),
        (6.5, {"known": True, "value": 1}),
    ]
    ready = [one["value"] for _, one in found["/rvmon/signals/arm/ready"]]
    assert ready == [False, True, False]
    assert next(one for _, one in found["/rvmon/events/pick"]) == {"occurs": True, "id": 7}


def test_the_layout_shows_what_is_there(base):
    main(["run", "base.rv", "a.csv", "--mcap", "v.mcap", "--quiet"])
    _, kinds = read_back(base / "v.mcap")
    layout = json.loads((base / "v.mcap.layout.json").read_text())
    panels = layout["configById"]
    text = json.dumps(layout["layout"])
    assert set(re.findall(r'"(\w+!\w+)"', text)) == panels.keys()
    paths = [path for panel in panels.values() for path in panel.get("paths", ())]
    numbers = []
    for path in paths:
        topic, _, field = path["value"].rpartition(".")
        if path["value"].startswith("/"):
            assert field in kinds[topic][1], path
        else:
            numbers.append((float(path["value"]), path["label"]))
    assert (2.0, "speed < 2") in numbers
    assert panels["Log!attempts"]["topicToRender"] in kinds
    shown = {path["value"].rpartition(".")[0] for path in paths}
    assert {topic for topic in kinds if "/events/" not in topic} - shown == {"/rvmon/attempts"}


def test_a_scene_has_its_bodies_in_place():
    """In the vertical plane x, z; static parts do not move; angles turn x towards z."""
    outlines = (
        Outline("arm", ((-1.0, 0.0), (1.0, 0.0)), 0.05, "link"),
        Outline("hand", ((0.0, 0.0),), 0.1, "person"),
        Outline("table", ((0.0, 0.0), (1.0, 0.0), (1.0, -0.1)), 0.0, "ground"),
    )
    turned = (2.0, 3.0, math.pi / 2)
    frames = ((0, (*turned, 0.0, 1.0, 0.0)), (10**9, (*turned, 0.5, 1.0, 0.0)))
    scene = Scene(("arm", "hand"), outlines, frames, (-1, -1, 1, 1))
    (t, first), (later, second) = scene_updates(scene)
    assert (t, later) == (0, 10**9)
    arm, table = first["entities"][0]["lines"]
    assert arm["pose"]["position"] == {"x": 2.0, "y": 0.0, "z": 3.0}
    # Rotated by -90 degrees about y, (1, 0, 0) becomes (0, 0, 1).
    y, w = arm["pose"]["orientation"]["y"], arm["pose"]["orientation"]["w"]
    assert (round(1 - 2 * y * y, 9), round(-2 * y * w, 9)) == (0, 1)
    assert (arm["type"], table["type"]) == (0, 1)
    assert table["pose"]["position"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    hands = [one["entities"][0]["spheres"][0] for one in (first, second)]
    assert [one["pose"]["position"]["x"] for one in hands] == [0.0, 0.5]
    assert hands[0]["size"] == {"x": 0.2, "y": 0.2, "z": 0.2}


def test_a_bag_keeps_its_clock(base):
    pytest.importorskip("rosbags")
    write_ros1(base / "a.bag", [("/speed", START + t, {"data": 1.0 + t}) for t in range(3)])
    words = ["run", "base.rv", "a.bag", "--only", "R2", "--mcap", "v.mcap", "--quiet"]
    assert main(words) == 1
    from mcap.reader import make_reader

    with (base / "v.mcap").open("rb") as file:
        found = [(one.topic, said.log_time) for _, one, said in make_reader(file).iter_messages()]
    assert {topic for topic, _ in found} == {
        "/rvmon/attempts",
        "/rvmon/requirements/R2",
        "/rvmon/signals/speed",
    }
    assert ("/rvmon/attempts", START + 1) in found


def test_late_rows_stand_in_their_place(base):
    (base / "base.rv").write_text(SPEC.replace('"A base"\n', '"A base"\nmax delay 2 s\n'))
    (base / "a.csv").write_text("t,speed,arm.ready,pick.id\n0,1,0,\n3,3,,\n2,1.5,,\n9,1,,\n")
    assert main(["run", "base.rv", "a.csv", "--mcap", "v.mcap", "--quiet"]) == 1
    found, _ = read_back(base / "v.mcap")
    assert [t for t, _ in found["/rvmon/signals/speed"]] == [0, 2, 3, 9]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["a.csv", "--mcap", "v.json"], "the name of an MCAP file ends in .mcap"),
        (["a.csv", "b.csv", "--mcap", "v.mcap"], "--mcap shows one recording, and there are 2"),
        (["a.csv", "--mcap", "no/v.mcap"], "there is no folder no"),
        (["c.mcap", "--mcap", "c.mcap"], "it is an input"),
        (["early.csv", "--mcap", "v.mcap"], "MCAP has no instants before 0 s"),
    ],
)
def test_mistakes_are_told(base, says, words, told):
    (base / "c.mcap").write_bytes(b"")
    (base / "b.csv").write_text(ROWS)
    (base / "early.csv").write_text("t,speed,arm.ready,pick.id\n-1,1,1,\n")
    assert told in says(2, "run", "base.rv", *words).err
    assert not (base / "v.mcap").exists()
