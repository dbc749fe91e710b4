"""`rvmon init` with recordings of messages: the specification passes on its recording."""

import pytest
from tests.tools.bags import START, write_json_mcap, write_ros1

from rvmon.cli import main

pytestmark = pytest.mark.slow

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

TYPES = {
    "/joints": "sensor_msgs/msg/JointState",
    "/odom": "nav_msgs/msg/Odometry",
    "/battery": "sensor_msgs/msg/BatteryState",
    "/present": "std_msgs/msg/Bool",
    "/temp": "std_msgs/msg/Float64",
    "/note": "std_msgs/msg/String",
    "/go": "std_msgs/msg/Empty",
    "/done": "std_msgs/msg/Empty",
}


def arm(count=40):
    """Messages of a moving arm whose battery is always present."""
    for tick in range(count):
        t, x = START + tick * 10**8, tick / 7
        names = ["shoulder_joint", "elbow_joint"] if tick % 2 else ["finger_joint"]
        yield "/joints", t, {"name": names, "position": [x] * len(names)}
        yield "/odom", t + 10, {"twist": {"twist": {"linear": {"x": x}}}}
        yield "/battery", t + 20, {"present": True, "voltage": 24.0}
        yield "/present", t + 30, {"data": True}
        yield "/note", t + 35, {"data": "busy" if tick % 3 else "idle"}
        if tick % 10 == 5:
            yield "/go", t + 40, {}
            yield "/done", t + 10**7, {}


def written(tmp_path, bag, says):
    """The specification on one line, after a check and a run without warnings and failures."""
    made = tmp_path / "made.rv"
    assert main(["init", str(bag), "-o", str(made), "--force"]) == 0
    says(0, "check", made, "--strict")
    told = says(0, "run", made, bag, "--strict")
    assert "warning" not in told.err + told.out
    return " ".join(made.read_text().split())


def test_signals_have_names_of_joints_and_units_and_a_constant_is_no_event(tmp_path, says):
    text = written(tmp_path, write_ros1(tmp_path / "a.bag", [*arm()], TYPES), says)
    text = text.replace(" :", ":")
    for joint in ("shoulder_joint", "elbow_joint", "finger_joint"):
        assert f"signal joints.position.{joint}" in text
    assert "signal odom.twist.twist.linear.x: real [m/s]" in text
    assert "odom.twist.twist.linear.x <= 5.58 m/s" in text
    assert "upon go then within 10 ms done" in text
    assert "event present" not in text
    assert "event battery.present" not in text
    assert "battery.voltage: real [V] # always 24;" in text
    assert "battery.voltage >= 24" not in text
    assert "signal note: {idle, busy}" in text


def test_a_rare_constant_is_an_event_only_if_alone_in_its_message(tmp_path, says):
    sent = [message for message in arm() if message[0] not in ("/battery", "/present")]
    for tick in (3, 4, 5, 6, 7, 8, 37):
        at = START + tick * 10**8
        sent.append(("/battery", at + 20, {"present": True, "voltage": 24.0}))
        sent.append(("/present", at + 30, {"data": True}))
    sent.sort(key=lambda message: message[1])
    text = written(tmp_path, write_ros1(tmp_path / "a.bag", sent, TYPES), says)
    assert "event battery.present" not in text
    assert "battery.present: bool" in text.replace(" :", ":")
    assert "event present" in text


def test_a_joint_whose_name_is_no_word_is_left_out_with_the_reason(tmp_path, says):
    sent = [("/joints", START, {"name": ["a", "wrist.1"], "position": [0.5, 0.25]})]
    text = written(tmp_path, write_ros1(tmp_path / "a.bag", sent, TYPES), says)
    assert "joints.position[wrist.1], " in text
    assert ": its name is not a word: bind it" in text


@pytest.mark.parametrize("plugin", ["sqlite3", "mcap"])
def test_topics_without_messages_are_left_out(tmp_path, says, plugin):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.LATEST)
    number = store.types["std_msgs/msg/Float64"]
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin[plugin.upper()])
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=store)
            for topic, kind in TYPES.items()
        }
        for tick in range(10):
            data = store.serialize_cdr(number(data=float(tick)), "std_msgs/msg/Float64")
            writer.write(connections["/temp"], START + tick * 10**8, data)
    text = written(tmp_path, tmp_path / "bag", says)
    assert "signal temp" in text
    for name in ("note", "go", "present", "joints"):
        assert f"signal {name}" not in text
    assert "no value in the recording" in text


@pytest.mark.parametrize(
    ("sent", "told"),
    [
        # /speed falls silent early, yet it is evaluated to the end of the recording.
        (
            [
                *(("/speed", START + n * 10**7, {"data": n / 8}) for n in range(20)),
                ("/pick", START + 10**9, {"items": []}),
            ],
            "signal speed",
        ),
        ([("/mode", START + n * 10**8, {"data": f"line {n}"}) for n in range(40)], "event mode"),
    ],
    ids=["silence", "texts"],
)
def test_a_topic_that_falls_silent_is_a_signal_and_free_text_an_event(tmp_path, says, sent, told):
    assert told in written(tmp_path, write_json_mcap(tmp_path / "a.mcap", sent), says)


def test_empty_recordings_are_refused_and_unreadable_topics_left_out(tmp_path, says):
    from mcap.writer import Writer

    write_json_mcap(tmp_path / "empty.mcap", [])
    assert "empty.mcap" in says(2, "init", tmp_path / "empty.mcap", "-o", "-").err
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        speed, count = (writer.register_channel(name, "json", 0) for name in ("/speed", "/count"))
        writer.add_message(count, START, b'{"data": 12', START)
        for n in range(40):
            t = START + n * 10**8
            writer.add_message(speed, t, b'{"data": %d}' % n, t)
        writer.finish()
    text = written(tmp_path, tmp_path / "a.mcap", says)
    assert "count" in text.partition("# What cannot be declared, and why:")[2]
