"""Composed transforms of frames; patterns of topics; comparisons of elements."""

import math
import random

import pytest
from tests.tools.bags import START, write_ros1

import rvmon
from rvmon.errors import RvmonError, TraceError
from rvmon.recordings.messages.transforms import Transform, requested_pairs

pytest.importorskip("rosbags")

TYPES = {
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/robot_1/odom": "nav_msgs/msg/Odometry",
    "/robot_2/odom": "nav_msgs/msg/Odometry",
    "/scan": "sensor_msgs/msg/LaserScan",
}


SCAN = """
spec scan
signal near, clear : bool
requirement N
  always near
requirement C
  always clear
"""


def sent(outer, inner, shift, angle, topic="/tf"):
    """A transform with a rotation about the vertical axis."""
    x, y, z = shift
    half = angle / 2
    rotation = {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}
    transform = {"translation": {"x": x, "y": y, "z": z}, "rotation": rotation}
    one = {"header": {"frame_id": outer}, "child_frame_id": inner, "transform": transform}
    return topic, {"transforms": [one]}


def bag(path, messages):
    listed = [(topic, START + n * 10**9, content) for n, (topic, content) in enumerate(messages)]
    own = {"tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n"}
    return write_ros1(path, listed, types=TYPES, own=own)


def values(path, signal="tf.map.tool.translation.x"):
    spec = rvmon.loads(f"spec s\nsignal {signal} : real\nrequirement R\n always {signal} < 100")
    found = spec.recording(path)
    return [((one.t - START) // 10**9, round(one.values[signal], 6)) for one in found if one.values]


def test_a_transform_is_composed_over_frames_in_between(tmp_path):
    """With the last transform of each; there is no value before the chain is complete."""
    path = bag(
        tmp_path / "a.bag",
        [
            sent("base", "tool", (1, 0, 0), 0, "/tf_static"),
            sent("map", "odom", (10, 0, 0), math.pi / 2),
            sent("odom", "base", (2, 3, 0), 0),
            sent("world", "elsewhere", (9, 9, 9), 0),
            sent("odom", "base", (2, 4, 0), math.pi / 2),
            sent("map", "odom", (0, 0, 0), 0),
        ],
    )
    assert values(path) == [(2, 7.0), (4, 5.0), (5, 2.0)]
    assert values(path, "tf.tool.base.translation.x") == [(0, -1.0)]
    with pytest.raises(TraceError, match="holds no sample"):
        values(path, "tf.map.elsewhere.translation.x")


def test_the_way_there_and_back_is_none():
    rng = random.Random(4)
    for _ in range(200):
        turn = [rng.gauss(0, 1) for _ in range(4)]
        size = math.hypot(*turn)
        one = Transform(
            tuple(rng.uniform(-5, 5) for _ in range(3)), tuple(part / size for part in turn)
        )
        none = one.then(one.back())
        assert max(map(abs, none.shift)) < 1e-12
        assert abs(abs(none.turn[3]) - 1) < 1e-12


def test_a_binding_reads_a_heading_and_a_circle_of_frames_is_nowhere(tmp_path):
    path = bag(
        tmp_path / "a.bag",
        [
            sent("map", "base", (0, 0, 0), 1.25),
            sent("a", "b", (0, 0, 0), 0),
            sent("b", "a", (0, 0, 0), 0),
        ],
    )
    (tmp_path / "b.toml").write_text(
        '[bind.heading]\ntopic = "/tf/map/base"\nvalue = "yaw(rotation)"\n'
    )
    spec = rvmon.loads(
        "spec s\nsignal heading : real [rad]\nrequirement R\n always heading > 1.24 rad"
    )
    assert spec.evaluate(path, binding=tmp_path / "b.toml").verdicts["R"] == "P"
    with pytest.raises(TraceError, match="holds no sample"):
        values(path, "tf.map.a.translation.x")
    assert requested_pairs(["tf", "/tf", "/odom"]) == []


def test_a_pattern_is_the_one_topic_like_it_or_that_of_the_robot(tmp_path):
    odom = [(f"/robot_{n}/odom", {"twist": {"twist": {"linear": {"x": float(n)}}}}) for n in (1, 2)]
    text = '[bind.speed]\ntopic = "/robot_*/odom"\nvalue = "twist.twist.linear.x"\nunit = "m/s"\n'
    (tmp_path / "b.toml").write_text(text)
    (tmp_path / "c.toml").write_text('robot = "2"\n' + text)
    spec = rvmon.loads("spec s\nsignal speed : real [m/s]\nrequirement R\n always speed < 1.5 m/s")
    one, both = bag(tmp_path / "a.bag", odom[:1]), bag(tmp_path / "b.bag", odom)
    assert spec.evaluate(one, binding=tmp_path / "b.toml").verdicts["R"] == "P"
    with pytest.raises(TraceError, match="there are /robot_1/odom, /robot_2/odom: say which robot"):
        spec.evaluate(both, binding=tmp_path / "b.toml")
    assert spec.evaluate(both, binding=tmp_path / "c.toml").verdicts["R"] == "F"


@pytest.mark.parametrize(
    ("ranges", "near", "clear"),
    [
        ([2.0, 0.25, 1.0], "P", "F"),
        ([2.0, 1.0], "F", "P"),
        ([], "F", "P"),
        ([2.0, math.nan], "I", "I"),
        ([0.25, math.nan], "P", "F"),
        ([math.inf, 0.5], "F", "P"),
    ],
)
def test_elements_are_compared_any_and_all(tmp_path, ranges, near, clear):
    path = bag(tmp_path / "a.bag", [("/scan", {"ranges": ranges})])
    binding = '[bind.{0}]\ntopic = "/scan"\nvalue = "{1}"\n'
    text = binding.format("near", "any(ranges < 0.3)") + binding.format(
        "clear", "all(ranges >= 0.3)"
    )
    (tmp_path / "b.toml").write_text(text)
    spec = rvmon.loads(SCAN)
    found = spec.evaluate(path, binding=tmp_path / "b.toml").verdicts
    assert (found["N"], found["C"]) == (near, clear)


def test_what_is_no_comparison_of_an_array_is_told(tmp_path):
    spec = rvmon.loads("spec s\nsignal near : bool\nrequirement N\n always near")
    for value in ("any(ranges)", "any(ranges < a)", "all(3 < 4)"):
        (tmp_path / "b.toml").write_text(f'[bind.near]\ntopic = "/scan"\nvalue = "{value}"\n')
        with pytest.raises(RvmonError, match=r"compares an array with a number"):
            spec.reading(binding=tmp_path / "b.toml")
