"""The ROS 2 node, with a stand-in for rclpy, which pip cannot install."""

import json
import sys
from array import array
from types import SimpleNamespace

import pytest
from tests.rvmon.adapters import rclpy_stub as stub

from rvmon import RvmonError, Verdict, loads
from rvmon.adapters.messages import MessageFeed
from rvmon.adapters.ros2 import Ros2Source
from rvmon.live import Driver, SimulatedClock
from rvmon.trace.sample import HealthKind

SPEC = """
spec s
signal base.twist.linear.x : real
event stop
requirement R1
  always base.twist.linear.x <= 1
requirement R2
  upon stop
  then within 300 ms base.twist.linear.x == 0
"""
LATCHED = stub.QoSProfile(durability=stub.DurabilityPolicy.TRANSIENT_LOCAL)
CARELESS = stub.QoSProfile(reliability=stub.ReliabilityPolicy.BEST_EFFORT)


@pytest.fixture
def graph(monkeypatch):
    """Published topics: a twist, a stop with a bool, the time."""
    made = stub.install(monkeypatch)
    made.types = {
        "std_msgs/msg/Bool": stub.message(data="boolean"),
        "geometry_msgs/msg/Twist": stub.message(linear="geometry_msgs/Vector3"),
        "geometry_msgs/msg/Vector3": stub.message(x="double", y="double", z="double"),
        "rosgraph_msgs/msg/Clock": stub.message(clock="builtin_interfaces/Time"),
        "builtin_interfaces/msg/Time": stub.message(sec="int32", nanosec="uint32"),
    }
    made.publishers = {
        "/base/twist": ("geometry_msgs/msg/Twist", [LATCHED, LATCHED]),
        "/stop": ("std_msgs/msg/Bool", [CARELESS, LATCHED]),
        "/clock": ("rosgraph_msgs/msg/Clock", [CARELESS]),
        "/other": ("std_msgs/msg/Bool", [LATCHED]),
    }
    return made


@pytest.fixture
def started(graph):
    """A source that follows `/clock`, and its driver."""
    spec, clock = loads(SPEC), SimulatedClock()
    driver = Driver(spec, clock=clock, on_judged=lambda one: source.publish(one))
    feed = MessageFeed(driver, spec.schema, clock=clock)
    source = Ros2Source(feed, verdicts="/verdicts")
    with source:
        yield driver


def _at(graph, driver, milliseconds):
    graph.publish("/clock", clock=SimpleNamespace(sec=0, nanosec=milliseconds * 1_000_000))
    driver.work()


def _moves(graph, x):
    graph.publish("/base/twist", linear=SimpleNamespace(x=x, y=0.0, z=0.0))


def test_topics_are_judged_by_the_clock_of_a_simulator_and_verdicts_are_published(graph, started):
    """A deadline passes by `/clock`, without a message of its topic."""
    _at(graph, started, 0)
    _moves(graph, 1.5)
    graph.publish("/stop", data=True)
    _at(graph, started, 300)
    said = [json.loads(text) for topic, text in graph.sent if topic == "/verdicts"]
    assert [(one["attempt"], one["verdict"]) for one in said] == [("R1#1", "F")]
    _at(graph, started, 301)
    assert json.loads(graph.sent[-1][1])["attempt"] == "R2#1"
    assert graph.parameters == {"use_sim_time": True}


def test_requested_quality_of_service_follows_the_publishers(graph, started):
    """Reliable and latched if all publishers are: requesting more would receive nothing."""
    assert {*graph.subscriptions} == {"/clock"}  # earlier messages could not be stamped
    _at(graph, started, 0)
    assert "/other" not in graph.subscriptions
    asked = {topic: profile for topic, (_, profile, _) in graph.subscriptions.items()}
    assert asked["/base/twist"] == stub.QoSProfile(1000, durability=LATCHED.durability)
    assert asked["/stop"] == stub.QoSProfile(1000, CARELESS.reliability)


def test_a_topic_is_read_when_somebody_publishes_it(graph, started):
    _at(graph, started, 0)
    graph.publishers["/base"] = ("std_msgs/msg/Bool", [LATCHED])
    before = dict(graph.subscriptions)
    graph.call(graph.timers[0])
    assert {*graph.subscriptions} - {*before} == {"/base"}
    assert graph.subscriptions["/stop"] is before["/stop"]


def test_what_was_lost_is_unknown(graph, started):
    _at(graph, started, 0)
    _moves(graph, 0.5)
    started.work()
    _at(graph, started, 10)
    graph.call(graph.subscriptions["/base/twist"][2].message_lost, None)
    started.work()
    assert started.close()[""][0].verdicts["R1"] is Verdict.INCONCLUSIVE


@pytest.mark.parametrize("has_other_type", [False, True])
def test_a_later_publisher_that_cannot_be_received_is_reported(graph, started, has_other_type):
    """It offers less than earlier ones, or has another type: its content is unknown."""
    _at(graph, started, 0)
    _moves(graph, 0.5)
    if has_other_type:
        graph.publishers["/base/twist"] = ("geometry_msgs/msg/Twist std_msgs/msg/Bool", [LATCHED])
        graph.call(graph.timers[0])
        graph.call(graph.timers[0])
        graph.publishers["/base/twist"] = ("geometry_msgs/msg/Twist", [LATCHED])
    else:
        graph.call(graph.subscriptions["/base/twist"][2].incompatible_qos, None)
    _moves(graph, 0.5)
    _at(graph, started, 10)
    (report,) = started.close()[""]
    assert report.verdicts["R1"] is Verdict.INCONCLUSIVE
    assert [one.count for one in report.health if one.kind is HealthKind.DROPPED] == [1]


@pytest.mark.parametrize("several", [False, True])
def test_a_topic_that_can_never_be_read_is_lost_for_good(graph, caplog, several):
    """Its package is not installed, or it has two types: names that it may feed are unknown."""
    why = "is the package of std_msgs/msg/Bool installed?"
    if several:
        why = "it has several types, std_msgs/msg/Bool, std_msgs/msg/Int32"
        graph.publishers["/stop"] = ("std_msgs/msg/Bool std_msgs/msg/Int32", [LATCHED])
    else:
        del graph.types["std_msgs/msg/Bool"]
    spec, clock = loads(SPEC), SimulatedClock()
    driver = Driver(spec, clock=clock)
    with Ros2Source(MessageFeed(driver, spec.schema)):
        assert why in caplog.text
        _moves(graph, 0.5)
        clock.set_ns(10**9)
        driver.work()
    verdicts = driver.close()[""][0].verdicts
    assert verdicts == {"R1": Verdict.PASS, "R2": Verdict.INCONCLUSIVE}


@pytest.mark.parametrize("kind", ["sequence<float>", "sequence<float, 9>", "float[2]"])
def test_a_binding_may_read_arrays(graph, tmp_path, kind):
    graph.types["sensor_msgs/msg/LaserScan"] = stub.message(ranges=kind)
    graph.publishers = {"/scan": ("sensor_msgs/msg/LaserScan", [CARELESS])}
    (tmp_path / "b.toml").write_text('[bind.near]\ntopic = "/scan"\nvalue = "min(ranges)"\n')
    text = "spec s\nsignal near : real [m]\nrequirement R\n  always near > 0.5 m\n"
    spec = loads(text).reading(binding=tmp_path / "b.toml")
    driver = Driver(spec, clock=SimulatedClock())
    with Ros2Source(MessageFeed(driver, spec.schema)):
        graph.publish("/scan", ranges=array("f", [2.0, 0.25]))
    assert driver.close()[""][0].verdicts["R"] is Verdict.FAIL


def test_rclpy_that_is_missing_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    spec = loads(SPEC)
    with pytest.raises(RvmonError, match="dds:DOMAIN"):
        Ros2Source(MessageFeed(Driver(spec, clock=SimulatedClock()), spec.schema))
