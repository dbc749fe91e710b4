"""The same data in every format of messages, written by the libraries of that format."""

import gc
import random
import sqlite3
import struct

import pytest
from tests.rvmon.recordings.messages.flatbuffers import (
    message_of,
    packed,
    schema_of,
    write_flatbuffer_mcap,
)
from tests.rvmon.recordings.shop import HEADER, OF_MESSAGES, SHOP, sent_at_random, write_csv
from tests.tools.bags import START, write_json_mcap, write_ros1, write_ros2

import rvmon
from rvmon.recordings.messages.flatbuffer import FlatBuffers
from rvmon.verdicts.report import Report

pytest.importorskip("rosbags")
pytest.importorskip("mcap_protobuf")


FORMATS = {
    **OF_MESSAGES,
    "d.mcap": lambda path, sent: write_json_mcap(path, sent, encoding="msgpack"),
    "e.mcap": lambda path, sent: write_json_mcap(path, sent, encoding="cbor", schemas=False),
    "bz2.bag": lambda path, sent: write_ros1(path, sent, compression="bz2"),
    "lz4.bag": lambda path, sent: write_ros1(path, sent, compression="lz4"),
    "f.mcap": write_flatbuffer_mcap,
}
"""By the name of a recording."""


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
def test_the_same_data_gives_the_records_that_csv_gives(tmp_path, name):
    spec = rvmon.loads(SHOP)
    verdicts = set()
    for seed in range(4):
        sent = sent_at_random(random.Random(seed), 120)
        table = write_csv(tmp_path / f"{seed}.csv", sent, HEADER)
        folder = tmp_path / str(seed)
        folder.mkdir()
        path = FORMATS[name](folder / name, sent)
        expected, found = spec.evaluate(table), spec.evaluate(path)
        assert found.attempts == expected.attempts
        assert (found.verdicts, found.end) == (expected.verdicts, expected.end)
        assert repr(found.health) == repr(expected.health)
        assert repr(samples(spec, path)) == repr(samples(spec, table))
        verdicts |= {str(attempt.verdict) for attempt in found.attempts}
    assert {"P", "F"} <= verdicts
    gc.collect()  # a file left open would be reported


def samples(spec, path):
    return [(sample.t, sorted(sample.values.items())) for sample in spec.recording(path)]


@pytest.mark.parametrize("name", FORMATS)
def test_a_deadline_passes_while_other_topics_continue(tmp_path, name):
    """A recording ends with its last message, even of an undeclared topic."""
    sent = [("/go", START, {}), ("/speed", START + 10**9, {"data": 1.0})]
    path = FORMATS[name](tmp_path / name, sent)
    spec = rvmon.loads("spec s\nevent go\nrequirement R\n upon go then for 500 ms go")
    assert spec.evaluate(path).verdicts["R"] == "F"
    spec = rvmon.loads("spec s\nevent go\nrequirement R\n upon go then within 500 ms (not go)")
    assert spec.evaluate(path).verdicts["R"] == "P"
    assert spec.evaluate(path).end == START + 10**9


def test_tables_in_tables_and_arrays_of_flatbuffers_are_read(tmp_path):
    pose, later = {"x": 1.5, "frame": "map"}, {"x": 0.0, "frame": "odom"}
    sent = [
        ("/arm", START, {"pose": pose, "ranges": [3.0, 0.5], "on": True}),
        ("/arm", START + 10**9, {"pose": later, "ranges": [2.0], "on": False}),
    ]
    path = write_flatbuffer_mcap(tmp_path / "a.mcap", sent)
    spec = rvmon.loads(
        "signal x, near : real\nsignal on : bool\nsignal frame : {map, odom}\nrequirement R\n"
        "  always ((on -> x == 1.5 and near == 0.5) and (frame == odom -> x == 0 and near == 2))\n"
    )
    values = {"x": "pose.x", "near": "min(ranges)", "on": "on", "frame": "pose.frame"}
    binding = tmp_path / "a.toml"
    binding.write_text(
        "".join(f'[bind.{name}]\ntopic = "/arm"\nvalue = "{own}"\n' for name, own in values.items())
    )
    spec = spec.reading(binding=binding)
    assert spec.evaluate(path).verdicts["R"] == "P"
    assert [one.t for one in spec.recording(path)] == [START, START + 10**9]


def test_a_field_that_is_null_in_the_first_json_message_exists(tmp_path):
    """Its kind is unknown; an event is not a field of each message."""
    contents = [
        {"near": None, "all": [], "data": None},
        {"near": 0.5, "all": [2.0], "data": False},
        {"near": 1.5, "all": [3.0], "data": True},
    ]
    sent = [("/stop", START + t, {"data": one.pop("data")}) for t, one in enumerate(contents)]
    sent += [("/scan", START + t, one) for t, one in enumerate(contents)]
    path = write_json_mcap(tmp_path / "a.mcap", sent, schemas=False)
    spec = rvmon.loads(
        "event stop\nsignal scan.near, first : real\nrequirement R\n"
        "  upon stop\n  then scan.near == 1.5 and first == 3\n"
    )
    attempts = spec.evaluate(path, columns={"first": "/scan.all[0]"}).attempts
    assert [(one.triggered, str(one.verdict)) for one in attempts if not one.in_doubt] == [
        (START + 2, "P")
    ]


def test_names_of_json_may_have_dots_themselves(tmp_path, says):
    content = {"base.x": 9.0, "arm": {"tip.z": 0.5}, "red hot": 1.0}
    path = write_json_mcap(tmp_path / "a.mcap", [("/a", START, content), ("/a", START + 1, {})])
    spec = rvmon.loads(
        "signal a.base.x, a.arm.tip.z : real\n"
        "requirement R1\n  always a.base.x < 1\nrequirement R2\n  always a.arm.tip.z < 1\n"
    )
    assert spec.evaluate(path).verdicts == {"R1": "F", "R2": "P"}
    told = says(0, "look", path)
    assert "base.x" in told.out
    assert "left out: a.red hot: its name is not a word" in told.out


@pytest.mark.slow
def test_damaged_flatbuffers_are_told(tmp_path):
    rng = random.Random(5)
    fields = {"x": 1.5, "name": "map", "inner": {"y": 2.0, "on": True}, "all": [1.0, 2.0]}
    schema, message = schema_of("a.B", fields), packed(message_of(fields))
    whole = FlatBuffers(schema, "a.B").decode(message)
    assert whole | {"all": list(whole["all"])} == fields
    told = set()
    for _ in range(3_000):
        both = [bytearray(schema), bytearray(message)]
        hurt = both[rng.random() < 0.5]
        hurt[rng.randrange(len(hurt))] = rng.choice([0, 1, 127, 255, rng.randrange(256)])
        try:
            FlatBuffers(bytes(both[0]), "a.B").decode(bytes(both[1]))
        except (ValueError, IndexError, KeyError, struct.error) as error:
            told.add(type(error))
    assert len(told) > 1


def test_an_older_bag_of_ros_2_needs_no_definitions_of_standard_types(tmp_path):
    """sqlite3 bags contain definitions from version 7 on."""
    sent = [("/speed", START, {"data": 1.0}), ("/pick", START + 1, {"id": 1})]
    path = write_ros2(tmp_path / "old", sent, "sqlite3", 8)
    import apsw

    database = apsw.Connection(str(path / "old.db3"))
    database.execute("UPDATE schema SET schema_version = 3")
    database.close()
    spec = rvmon.loads("spec s\nsignal speed : real\nrequirement R\n  always speed < 2\n")
    assert spec.evaluate(path).verdicts["R"] == "P"
    assert spec.evaluate(path / "old.db3").verdicts["R"] == "P"
    spec = rvmon.loads("spec s\nevent pick\nrequirement R\n  upon pick then for 1 ms pick\n")
    with pytest.raises(rvmon.TraceError, match=r"/pick \(shop_msgs/msg/Pick\).*`definitions`"):
        spec.evaluate(path)


@pytest.mark.slow
@pytest.mark.parametrize("plugin", ["sqlite3", "mcap"])
def test_a_folder_that_was_never_closed_is_read(tmp_path, says, plugin):
    """Also by the command."""
    sent = sent_at_random(random.Random(1), 60)
    (tmp_path / "shop.rv").write_text(SHOP)
    spec = rvmon.load(tmp_path / "shop.rv")
    folder = write_ros2(tmp_path / "bag", sent, plugin)
    report = spec.evaluate(folder)
    (folder / "metadata.yaml").unlink()
    assert spec.evaluate(folder) == report
    told = says(1, "run", tmp_path / "shop.rv", folder, "--format", "json").out
    again = Report.from_json(told)
    assert (again.attempts, again.end) == (report.attempts, report.end)
    write_ros2(folder / "more", sent, plugin)
    with pytest.raises(rvmon.TraceError, match="holds 2 recordings"):
        spec.evaluate(folder)


@pytest.mark.slow
@pytest.mark.parametrize("distribution", ["ROS2_DASHING", "ROS2_FOXY", "ROS2_HUMBLE", "LATEST"])
def test_a_bag_without_definitions_uses_those_of_its_distribution(tmp_path, distribution):
    """`sensor_msgs/Range` got a field after Humble; older bags have no definitions."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores[distribution])
    kinds = store.types
    stamp = kinds["builtin_interfaces/msg/Time"](1, 0)
    rest = (0.5,) if distribution == "LATEST" else ()
    header = kinds["std_msgs/msg/Header"](stamp, "sonar")
    said = kinds["sensor_msgs/msg/Range"](header, 0, 0.5, 0.25, 8.0, 1.5, *rest)
    path = write_ros2(tmp_path / "bag", [("/speed", START, {"data": 1.0})], "sqlite3", version=8)
    [file] = path.glob("*.db3")
    with sqlite3.connect(file) as base:
        base.execute("UPDATE topics SET name = '/sonar', type = 'sensor_msgs/msg/Range'")
        raw = bytes(store.serialize_cdr(said, "sensor_msgs/msg/Range"))
        base.execute("UPDATE messages SET data = ?", (raw,))
    base.close()
    metadata = path / "metadata.yaml"
    text = metadata.read_text().replace("name: /speed", "name: /sonar")
    metadata.write_text(text.replace("std_msgs/msg/Float64", "sensor_msgs/msg/Range"))
    text = "spec s\nsignal sonar.range : real\nrequirement R\n always sonar.range == 1.5"
    spec = rvmon.loads(text)
    assert spec.evaluate(path).verdicts["R"] == "P"


@pytest.mark.parametrize(
    ("type_name", "definition", "why"),
    [
        (
            "shop_msgs/msg/Tool",
            "shop_msgs/msg/Grip grip\n",
            " names shop_msgs/msg/Grip, and does not define it",
        ),
        ("3d_msgs/msg/Tool", "int32 id\n", " cannot be read (`3d_msgs` is not a name)"),
    ],
    ids=["lacks a part", "no name"],
)
def test_a_faulty_definition_is_a_fault_of_its_topic(tmp_path, type_name, definition, why, says):
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        kind = writer.register_schema(type_name, "ros2msg", definition.encode())
        channel = writer.register_channel("/tool", "cdr", kind)
        writer.add_message(channel, START, b"\0\1\0\0\1", START)
        writer.finish()
    assert f"`tool`: the definition of its messages{why}" in says(2, "init", path).err
