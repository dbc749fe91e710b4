"""Bindings proposed for recordings of robots are correct or left open."""

import math
import tomllib

import pytest
from tests.rvmon.recordings.binding.robots import ROBOTS, Robot
from tests.tools.bags import START, write_ros1

import rvmon
from rvmon.cli import main

pytest.importorskip("rosbags")


def write(robot, folder):
    """The recording and the specification of a robot."""
    types = {topic: kind for topic, (kind, _) in robot.topics.items()}
    sent = [
        (topic, START + turn * 10**8 + place, content)
        for turn in range(3)
        for place, (topic, (_, content)) in enumerate(robot.topics.items())
    ]
    bag = write_ros1(folder / "a.bag", sent, types, robot.definitions)
    spec = folder / "a.rv"
    spec.write_text(f"spec robot\n{robot.declared}\nrequirement R1\n  always true\n")
    return str(spec), str(bag)


def flat(tables, prefix=""):
    """The place of each name."""
    for key, table in tables.items():
        if "topic" in table:
            place = f"{table['topic']} {table.get('value', '')}".strip()
            yield prefix + key, place + (f" [{table['unit']}]" if "unit" in table else "")
        else:
            yield from flat(table, f"{prefix}{key}.")


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_proposals_are_correct_or_left_open(name, tmp_path, capsys):
    """Correct where the recording decides, open otherwise; the result passes `check`, and runs."""
    robot = ROBOTS[name]
    spec, bag = write(robot, tmp_path)
    status = main(["init", bag, "--for", spec])
    told = capsys.readouterr()
    found = dict(flat(tomllib.loads(told.out).get("bind", {})))
    wrong = {
        one: found.get(one, "")
        for one, places in robot.expected.items()
        if not {found.get(one, ""), found.get(one, "").partition(" [")[0]} & {*(places or ("",))}
    }
    assert not wrong
    open_ones = [one for one in robot.expected if one not in found]
    assert status == int(bool(open_ones))
    for one in open_ones:
        assert f"`{one}`" in told.out
        assert f"`{one}`" in told.err
    binding = tmp_path / "a.toml"
    binding.write_text(told.out)
    assert main(["check", spec, "--binding", str(binding)]) == 0
    rvmon.load(spec).evaluate(bag, binding=binding, allow_missing=True)


def test_a_ratio_that_is_sent_as_per_cent_is_told(tmp_path, says):
    topics = {"/battery": ("sensor_msgs/msg/BatteryState", {"percentage": 75.0})}
    spec, bag = write(Robot(topics, "signal battery_level : real [%]"), tmp_path)
    told = says(0, "init", bag, "--for", spec).out
    assert 'value = "percentage"  # always 75\nunit = "1"\n# It looks like per cent' in told
    binding = tmp_path / "a.toml"
    binding.write_text(told.replace('"percentage"', '"1 * percentage"').replace('"1"', '"%"'))
    assert main(["check", spec, "--binding", str(binding)]) == 0


@pytest.mark.parametrize(("turn", "value"), [("yaw", 0.5), ("pitch", 0.2), ("roll", -0.3)])
def test_turns_of_a_quaternion(tmp_path, turn, value):
    halves = (0.25, 0.1, -0.15)
    (cz, cy, cx), (sz, sy, sx) = map(math.cos, halves), map(math.sin, halves)
    turned = {
        "w": cx * cy * cz + sx * sy * sz,
        "x": sx * cy * cz - cx * sy * sz,
        "y": cx * sy * cz + sx * cy * sz,
        "z": cx * cy * sz - sx * sy * cz,
    }
    robot = Robot(
        {"/imu": ("sensor_msgs/msg/Imu", {"orientation": turned})},
        "signal angle : real [rad]\nrequirement A1\n"
        f"  always abs(angle - ({value} rad)) < 1e-9 rad",
    )
    spec, bag = write(robot, tmp_path)
    binding = tmp_path / "a.toml"
    binding.write_text(
        f'[bind.angle]\ntopic = "/imu"\nvalue = "{turn}(orientation)"\nunit = "rad"\n'
    )
    assert main(["run", spec, bag, "--binding", str(binding)]) == 0


@pytest.mark.slow
def test_a_unit_in_a_comment_counts_in_a_binding(tmp_path, capsys):
    """Milliamps for a signal in amps are an error unless the binding names the unit."""
    spec, bag = write(ROBOTS["create3"], tmp_path)
    binding = tmp_path / "a.toml"
    place = '[bind.left_wheel_current]\ntopic = "/wheel_status"\nvalue = "current_ma_left"\n'
    binding.write_text(place)
    assert main(["run", spec, bag, "--binding", str(binding), "--allow-missing"]) == 2
    assert 'write `unit = "mA"` in a binding' in capsys.readouterr().err
    binding.write_text(f'{place}unit = "mA"\n')
    assert main(["run", spec, bag, "--binding", str(binding), "--allow-missing"]) == 0


DATABASE = """VERSION ""
BS_:
BU_: ECU
BO_ 256 Drive: 8 ECU
 SG_ Speed : 0|8@1+ (1,0) [0|0] "furlong/h" ECU
 SG_ Compass : 8|8@1+ (1.5,0) [0|0] "mGauss" ECU
 SG_ Height : 16|16@1+ (1,0) [0|0] "" ECU
 SG_ Clearance : 32|8@1+ (1,0) [0|0] "" ECU
"""


@pytest.mark.slow
def test_an_unknown_scale_is_left_open(tmp_path, capsys):
    """An unknown unit, or a whole number too large for the plain unit."""
    pytest.importorskip("cantools")
    (tmp_path / "a.dbc").write_text(DATABASE)
    (tmp_path / "a.log").write_text("".join(f"({t}.0) can0 100#0A0A60EA05000000\n" for t in (1, 2)))
    names = (
        "speed : real [m/s]",
        "compass : real [gauss]",
        "height : real [m]",
        "clearance : real [m]",
    )
    spec = tmp_path / "a.rv"
    declared = "".join(f"signal drive_{name}\n" for name in names)
    spec.write_text(f"spec car\n{declared}requirement R1\n  always true\n")
    assert main(["init", str(tmp_path / "a.log"), "--for", str(spec)]) == 1
    assert dict(flat(tomllib.loads(capsys.readouterr().out)["bind"])) == {
        "drive_compass": "/Drive Compass [mgauss]",
        "drive_clearance": "/Drive Clearance [m]",
    }


def test_a_constant_number_is_not_a_clear_choice(tmp_path, says):
    """A planar vehicle reports a pitch of 0, while another topic has the real one."""
    imu = [{"angular_velocity": {"y": rate}} for rate in (0.1, 0.2)]
    sent = [("/odom", START, {}), ("/imu", START + 1, imu[0]), ("/imu", START + 2, imu[1])]
    types = {"/odom": "nav_msgs/msg/Odometry", "/imu": "sensor_msgs/msg/Imu"}
    bag = write_ros1(tmp_path / "a.bag", sent, types)
    spec = tmp_path / "a.rv"
    spec.write_text("spec s\nsignal pitch_rate : real [rad/s]\nrequirement R1\n  always true\n")
    told = says(1, "init", bag, "--for", spec).out
    assert '# topic = "/odom", value = "twist.twist.angular.y"  # always 0' in told
    assert '# topic = "/imu", value = "angular_velocity.y"  # 0.1 … 0.2' in told
