"""Recordings as robots make them, with what should feed which name; they stand in `recordings`.

The expected places were written down before anything was proposed for them: topic and value,
several (`|`) where any of them is right, `open` where it may be left open, none where nothing in
the recording is what the name says.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Kind = tuple[str, Mapping[str, Any]]
"""Type and content of the messages of a topic."""


@dataclass(frozen=True)
class Robot:
    """A recording, a specification, and the correct binding.

    Attributes:
        topics: type and content of the messages of each topic.
        declared: the body of a specification.
        expected: by name, `TOPIC VALUE`; empty: it is to be left open.
        definitions: of messages of its own.
    """

    topics: Mapping[str, Kind]
    declared: str
    expected: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    definitions: Mapping[str, str] = field(default_factory=dict)


KINDS: dict[str, Kind] = {
    "odometry": (
        "nav_msgs/msg/Odometry",
        {
            "child_frame_id": "base_link",
            "pose": {"pose": {"position": {"x": 1.5, "y": -2.0}, "orientation": {"w": 1.0}}},
            "twist": {"twist": {"linear": {"x": 0.5}, "angular": {"z": 0.1}}},
        },
    ),
    "imu": ("sensor_msgs/msg/Imu", {"header": {"frame_id": "imu_link"}, "orientation": {"w": 1.0}}),
    "twist": ("geometry_msgs/msg/Twist", {"linear": {"x": 0.6}}),
    "pose": (
        "geometry_msgs/msg/PoseStamped",
        {"pose": {"position": {"x": 1.0, "z": 2.0}, "orientation": {"w": 1.0}}},
    ),
    "float": ("std_msgs/msg/Float64", {"data": 1.5}),
    "bool": ("std_msgs/msg/Bool", {"data": False}),
    "text": ("std_msgs/msg/String", {"data": "idle"}),
    "fix": ("sensor_msgs/msg/NavSatFix", {"latitude": 48.1, "longitude": 11.5, "altitude": 510.0}),
    "battery": (
        "sensor_msgs/msg/BatteryState",
        {"voltage": 24.5, "current": -2.0, "percentage": 0.75, "temperature": 31.0},
    ),
    "scan": (
        "sensor_msgs/msg/LaserScan",
        {"ranges": [2.0, 1.5, 3.0], "intensities": [9.0, 8.0, 7.0]},
    ),
    "range": ("sensor_msgs/msg/Range", {"header": {"frame_id": "sonar_front"}, "range": 1.2}),
    "temperature": ("sensor_msgs/msg/Temperature", {"temperature": 41.0}),
    "wrench": ("geometry_msgs/msg/WrenchStamped", {"wrench": {"force": {"x": 1.0}}}),
    "stamped_twist": ("geometry_msgs/msg/TwistStamped", {"twist": {"linear": {"x": 0.2}}}),
    "int": ("std_msgs/msg/Int32", {"data": 3}),
    "vector": ("geometry_msgs/msg/Vector3Stamped", {"vector": {"x": 1.5, "y": -12.0, "z": 88.0}}),
}
"""What many robots send."""


def _kind(told: Any) -> Kind:
    """A kind by its name, the state of some joints, or type and content."""
    if isinstance(told, list):
        return told[0], told[1]
    name, *joints = told.split()
    if name != "joints":
        return KINDS[name]
    numbers = [0.1 * place for place in range(len(joints))]
    content = {"name": joints, "position": numbers, "velocity": numbers, "effort": numbers}
    return "sensor_msgs/msg/JointState", content


def _places(told: str) -> tuple[str, ...]:
    """The correct places; `speeds TOPIC PATH` stands for those of a driving speed."""
    if not told.startswith("speeds "):
        return tuple("" if one == "open" else one for one in told.split(" | ")) if told else ()
    _, topic, *rest = told.split()
    unit = "".join(f" {one}" for one in rest if one.startswith("["))
    path = "".join(one for one in rest if not one.startswith("["))
    x, y = f"{path}linear.x", f"{path}linear.y"
    return f"{topic} {x}{unit}", f"{topic} hypot({x}, {y}){unit}"


def _robots(path: Path) -> dict[str, Robot]:
    tables = tomllib.loads(path.read_text("utf-8"))
    return {
        name: Robot(
            {topic: _kind(told) for topic, told in table["topics"].items()},
            "\n".join(table["names"]),
            {line.split()[1]: _places(told) for line, told in table["names"].items()},
            table.get("definitions", {}),
        )
        for name, table in tables.items()
    }


ROBOTS = {
    name: robot
    for path in sorted(Path(__file__).with_name("recordings").glob("*.toml"))
    for name, robot in _robots(path).items()
}
