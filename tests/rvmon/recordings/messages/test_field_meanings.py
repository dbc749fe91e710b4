"""The tables of the meanings of message fields."""

from importlib import resources

import pytest
from tests.tools.each import each

from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import Sort, is_listed, meaning_of
from rvmon.trace.schema import Kind

pytest.importorskip("rosbags")

PACKAGES = [
    "actionlib_msgs",
    "builtin_interfaces",
    "diagnostic_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "std_msgs",
    "tf2_msgs",
    "trajectory_msgs",
]


def topics_of_ros():
    """A topic for each message type that comes with ROS."""
    from rosbags.typesys import Stores, get_typestore

    from rvmon.recordings.messages.ros import ros_topic

    for store in (Stores.LATEST, Stores.ROS1_NOETIC):
        types = get_typestore(store)
        for name in types.fielddefs:
            if name.split("/")[0] in PACKAGES:
                text, _ = types.generate_msgdef(name)
                if not text.strip():  # an empty message
                    continue
                yield ros_topic("/topic", name, ("msg", text), False, {})[0]


@pytest.mark.slow
def test_each_field_of_the_standard_packages_is_listed():
    """Each number has a unit, or a reason why not; `?` marks those that senders decide."""
    left_open = set()
    for topic in topics_of_ros():
        assert not topic.fault
        assert is_listed(topic.type), topic.type
        for leaf, kind in topic.leaves.items():
            if kind in (Kind.INT, Kind.REAL) and meaning_of(leaf, topic).sort is Sort.OPEN:
                left_open.add(topic.type.split("/")[0] + "/" + topic.type.split("/")[-1])
    assert {one for one in left_open if not one.startswith("std_msgs/")} == {
        "geometry_msgs/Vector3",
        "geometry_msgs/Vector3Stamped",
        "sensor_msgs/ChannelFloat32",
        "sensor_msgs/LaserScan",  # intensities
        "sensor_msgs/PointCloud",  # its channels
    }


@each(
    ("type_name", "leaf", "units"),
    [
        ("nav_msgs/msg/Odometry", "twist.twist.linear.x", "m/s"),
        ("nav_msgs/Odometry", "twist.twist.angular.z", "rad/s"),
        ("sensor_msgs/msg/JointState", "position[]", "rad m"),
        ("sensor_msgs/msg/BatteryState", "percentage", ""),
        ("mavros_msgs/msg/VfrHud", "heading", "deg"),
        ("mavros_msgs/msg/SysStatus", "voltage_battery", "mV"),
        ("px4_msgs/msg/VehicleLocalPosition", "heading", "rad"),
        ("control_msgs/msg/JointTrajectoryControllerState", "error.positions[]", "rad m"),
        ("trajectory_msgs/msg/MultiDOFJointTrajectoryPoint", "accelerations[].linear.x", "m/s^2"),
    ],
)
def test_units_of_fields(type_name, leaf, units):
    """With and without the types that a definition names."""
    meaning = meaning_of(leaf, Topic("/topic", type_name, {}))
    assert meaning.sort is Sort.MEASURED
    assert [unit.symbol for unit in meaning.units] == (units.split() or [""])


def test_what_nobody_can_know_is_open():
    own = Topic("/own", "shop_msgs/msg/Own", {}, messages={"arm": "geometry_msgs/msg/Twist"})
    assert meaning_of("data", Topic("/t", "std_msgs/msg/Float64", {})).sort is Sort.OPEN
    assert meaning_of("x", own).sort is Sort.OPEN
    assert meaning_of("arm.linear.x", own).units[0].symbol == "m/s"
    assert meaning_of("pose.pose.orientation.x", Topic("/o", "nav_msgs/Odometry", {})).sort is (
        Sort.QUATERNION
    )


def test_all_tables_can_be_read():
    folder = resources.files("rvmon.recordings.messages") / "meanings"
    count = 0
    for table in folder.iterdir():
        package, name = table.name.removesuffix(".txt"), ""
        for line in table.read_text("utf-8").splitlines():
            if line.startswith("["):
                name = f"{package}/msg/{line.strip('[]')}"
                assert is_listed(name)
                continue
            field, entry, *_ = line.split()
            count += 1
            if entry.startswith("@"):
                assert is_listed(entry[1:]), (name, line)
            else:
                meaning = meaning_of(field, Topic("/topic", name, {}))
                assert (meaning.sort is Sort.MEASURED) == bool(meaning.units), (name, line)
    assert count > 3000
