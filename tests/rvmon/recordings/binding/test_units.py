"""A value in another unit than the declared one is an error, with place, cause and fix."""

import re

import pytest
from tests.tools.bags import START, write_ros1

import rvmon
from rvmon.errors import RvmonError

pytest.importorskip("rosbags")

SPEC = """
spec base
signal speed : real [m/s]
signal angle : real [rad]
signal far   : bool
event  seen(at: real [m])
requirement R1
  always speed < 1 m/s
"""
ODOM = '[bind.{name}]\ntopic = "/odom"\n{type}value = "{value}"\n{more}'
TYPE = 'type = "nav_msgs/msg/Odometry"\n'


def told(tmp_path, text, spec=SPEC):
    """The errors of a binding without a recording, and with a recording without types."""
    path = tmp_path / "base.toml"
    path.write_text(text)
    with pytest.raises(RvmonError) as error:
        rvmon.loads(spec).reading(binding=path)
    path.write_text(text.replace(TYPE, ""))
    bag = write_ros1(tmp_path / "a.bag", [("/odom", START, {})])
    with pytest.raises(rvmon.TraceError) as late:
        rvmon.loads(spec).evaluate(bag, binding=path, allow_missing=True)
    assert str(error.value).startswith(f"{path}: [bind.")
    known = str(error.value).partition("]: ")[2]
    assert known in str(late.value)
    return str(error.value)


@pytest.mark.parametrize(
    ("name", "value", "more", "message"),
    [
        (
            "speed",
            "twist.twist.angular.z",
            "",
            r"declared \[m/s\], and .* is in \[rad/s\]: bind a field in",
        ),
        ("speed", "pose.pose.position.x", 'unit = "m/s"', r"`pose.pose.position.x` .* in \[m\]"),
        ("speed", "pose.pose.orientation.x", "", "is a plain number"),
        ("speed", "twist.twist.linear.x", 'unit = "km/h"', r"says \[km/h\]: write `unit = \"m/s"),
        ("speed", "2 * twist.twist.angular.z", "", r"in \[rad/s\]"),
        ("speed", "max(abs(twist.twist.angular.z), 0)", "", r"in \[rad/s\]"),
        ("angle", "twist.twist.linear.x", 'unit = "deg"', r"in \[m/s\]"),
        ("far", "pose.pose.position.x > twist.twist.linear.x", "", "added or compared"),
        ("speed", "pose.pose.position.x + twist.twist.linear.x", "", "added or compared"),
    ],
)
def test_a_value_of_another_unit_is_an_error(tmp_path, name, value, more, message):
    text = ODOM.format(name=name, type=TYPE, value=value, more=more)
    assert re.search(message, told(tmp_path, text))


def test_an_angle_is_no_speed_whatever_feeds_it(tmp_path):
    path = tmp_path / "base.toml"
    path.write_text('[bind.speed]\ntopic = "/o"\nvalue = "yaw(q)"\nunit = "m/s"\n')
    with pytest.raises(RvmonError, match=r"\[bind.speed\]: .*`yaw\(q\)` of topic /o is in \[rad\]"):
        rvmon.loads(SPEC).reading(binding=path)


def test_a_field_found_by_its_name_is_compared_too(tmp_path, says):
    spec = "spec s\nsignal odom.twist.twist.linear.x : real [km/h]\nsignal turn : real [m]\n"
    body = "requirement R1\n  always odom.twist.twist.linear.x < 1 km/h\n"
    (tmp_path / "s.rv").write_text(spec + body)
    bag = str(write_ros1(tmp_path / "a.bag", [("/odom", START, {})]))
    found = says(2, "run", tmp_path / "s.rv", bag, "--allow-missing").err
    assert "is in [m/s]" in found
    assert 'write `unit = "m/s"` in a binding' in found
    (tmp_path / "s.rv").write_text((spec + body).replace("[km/h]", "[m/s]"))
    mapped = ["--map", "turn=/odom.twist.twist.angular.z"]
    assert "`turn` is declared [m]" in says(2, "run", tmp_path / "s.rv", bag, *mapped).err


def test_a_payload_is_compared_too(tmp_path):
    text = f'[bind.seen]\ntopic = "/odom"\n{TYPE}fields = {{ at = "twist.twist.linear.x" }}\n'
    assert "`seen.at` is declared [m], and `twist" in told(tmp_path, text)


def test_numbers_may_change_the_scale(tmp_path):
    """A binding for a robot with unusual units computes, and names the unit."""
    path = tmp_path / "base.toml"
    value = "1 * twist.twist.linear.x"
    path.write_text(ODOM.format(name="speed", type=TYPE, value=value, more='unit = "km/h"'))
    sent = [("/odom", START, {"twist": {"twist": {"linear": {"x": 3.0}}}})]
    run = rvmon.loads(SPEC).evaluate(
        write_ros1(tmp_path / "a.bag", sent), binding=path, allow_missing=True
    )
    assert run.verdicts["R1"] == "P"


def test_a_binding_of_another_robot_is_told(tmp_path):
    path = tmp_path / "base.toml"
    path.write_text('[bind.speed]\ntopic = "/odom"\ntype = "a_msgs/Own"\nvalue = "x"\n')
    bag = write_ros1(tmp_path / "a.bag", [("/odom", START, {})])
    with pytest.raises(rvmon.TraceError, match=r"holds nav_msgs/msg/Odometry, .* says a_"):
        rvmon.loads(SPEC).evaluate(bag, binding=path, allow_missing=True)
    path.write_text('[bind.speed]\ntopic = "/odom"\ntype = 3\nvalue = "x"\n')
    with pytest.raises(RvmonError, match="what is the type of the messages"):
        rvmon.loads(SPEC).reading(binding=path)
