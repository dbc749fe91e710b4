"""Topics of ROS 1 and ROS 2 with a real master and real DDS in separate processes."""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.tools.servers import LOOPBACK, SYSTEM, master_of_ros1, missing, rosmaster, until

from rvmon import RvmonError, Verdict, loads
from rvmon.adapters.messages import MessageFeed
from rvmon.live import Driver, Live, SimulatedClock
from rvmon.recordings.messages import Topic
from rvmon.trace.schema import Kind

SPEC = """
spec s
signal base.speed : real
event stop
requirement R1
  always base.speed <= 1
requirement R2
  upon stop
  then within 300 ms base.speed == 0
"""
EXAMPLES = Path(__file__).parents[3] / "examples"
LONG = 60.0
"""Seconds after which a process is ended that does not end."""

WATCH = f"import sys; sys.path.append({SYSTEM!r}); from rvmon.cli import main; sys.exit(main())"


@contextmanager
def _ended(process):
    """A process that neither outlives the test nor blocks it."""
    alarm = threading.Timer(LONG, process.kill)
    alarm.start()
    with process:
        try:
            yield process
        finally:
            alarm.cancel()
            process.kill()


def _failures(folder, source, talker, environment):
    """The output of `rvmon watch` up to the second failure; then it is ended by Ctrl-C."""
    environment = {**os.environ, **environment}
    watch = ["watch", EXAMPLES / "base.rv", source, "--format", "json"]
    command = [sys.executable, "-c", WATCH, *watch]
    with (
        _ended(subprocess.Popen(talker, env=environment)),  # noqa: S603
        _ended(
            subprocess.Popen(  # noqa: S603
                command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
            )
        ) as watching,
    ):
        lines = [json.loads(watching.stdout.readline()) for _ in range(2)]
        watching.send_signal(signal.SIGINT)
        last = json.loads(watching.communicate(timeout=LONG)[0].splitlines()[-1])
    assert watching.returncode == 1
    assert last["verdicts"] == {"B1": "F", "B2": "F"}
    return [(line["attempt"], line["verdict"]) for line in lines]


@pytest.fixture
def master():
    if rosmaster() is None:
        missing("rosmaster, or rospy")
    with master_of_ros1() as address:
        yield address


@pytest.mark.process
def test_topics_of_ros_1_are_judged(tmp_path, master):
    pytest.importorskip("rosbags")
    environment = {"ROS_MASTER_URI": master, "ROS_IP": "127.0.0.1", "ROS_HOME": str(tmp_path)}
    talker = ["/usr/bin/python3", EXAMPLES / "ros1" / "talker.py"]
    assert _failures(tmp_path, "ros1:", talker, environment) == [("B1#1", "F"), ("B2#1", "F")]


@pytest.mark.process
def test_topics_of_ros_2_are_judged_over_dds(tmp_path):
    """Without an installation of ROS, in a separate domain."""
    pytest.importorskip("cyclonedds")
    domain = str(100 + os.getpid() % 100)
    talker = [sys.executable, EXAMPLES / "dds" / "talker.py", domain]
    found = _failures(tmp_path, f"dds:{domain}", talker, {"CYCLONEDDS_URI": LOOPBACK})
    assert found == [("B1#1", "F"), ("B2#1", "F")]


@pytest.fixture
def robots(monkeypatch):
    """A DDS domain, a topic for a real signal, and a function that publishes it with a type."""
    pytest.importorskip("cyclonedds")
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic as DdsTopic

    from rvmon.adapters import dds

    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    domain, topic = 100 + os.getpid() % 100, f"speed{os.getpid()}"

    def publisher(name):
        kind, robot = dds._idl_type(f"std_msgs/msg/{name}", ()), DomainParticipant(domain)
        made.kept.append((robot, DataWriter(robot, DdsTopic(robot, f"rt/{topic}", kind))))
        return kind, made.kept[-1][1]

    spec = loads(f"signal {topic} : real\nrequirement R\n  always {topic} <= 1")
    made = SimpleNamespace(domain=domain, spec=spec, publisher=publisher, kept=[])
    yield made
    made.kept.clear()  # they leave the domain


def is_matched(matches):
    """Whether an endpoint has a match; `matches` lists them."""
    try:
        return bool(matches())
    except IndexError:  # the binding counts matches first, and one was added before it listed them
        return False


@pytest.mark.process
def test_a_second_publisher_of_another_type_cannot_be_heard_over_dds(robots):
    """The names fed by the topic stay unknown, also after a loss that has ended."""
    from rvmon.adapters.dds import DdsSource

    live = Live(robots.spec)
    kind, writer = robots.publisher("Float64")
    with live, DdsSource(MessageFeed(live, robots.spec.schema), domain=robots.domain):
        until(lambda: is_matched(writer.get_matched_subscriptions))
        writer.write(kind(data=0.5))
        until(lambda: live.status() and live.status()[""].samples == 1)
        robots.publisher("Float32")
        until(lambda: live.status()[""].lost == 1)
        writer.write(kind(data=0.5))
        until(lambda: live.status()[""].samples == 2)
    assert live.close()[""][0].verdicts == {"R": Verdict.INCONCLUSIVE}


FLEET = """
import sys
from threading import Barrier, Thread
from rvmon import loads
from rvmon.adapters import dds
from rvmon.adapters.messages import MessageFeed
from rvmon.live import Live

sys.setswitchinterval(1e-6)
spec, domain, begun = loads("signal p : bool"), int(sys.argv[1]), Barrier(12)
def make(number):
    with Live(spec) as live, dds.DdsSource(MessageFeed(live, spec.schema), domain=domain) as source:
        begun.wait()
        for kind in ("Bool", "Int64", "Float64", "String", "Empty"):
            source._wire_topic(f"{kind}{number}", f"std_msgs/msg/{kind}", ())
        begun.wait()
        print("made")
robots = [Thread(target=make, args=(number,)) for number in range(12)]
for one in robots:
    one.start()
for one in robots:
    one.join(20)
"""


@pytest.mark.process
def test_sources_that_begin_at_once_hear_alike():
    pytest.importorskip("cyclonedds")
    words = [sys.executable, "-c", FLEET, str(100 + os.getpid() % 100)]
    environment = {**os.environ, "CYCLONEDDS_URI": LOOPBACK}
    told = subprocess.run(words, capture_output=True, text=True, timeout=60, env=environment)  # noqa: S603 - the interpreter itself
    assert told.stdout.count("made") == 12, told.stderr


@pytest.mark.process
def test_messages_that_overflow_the_queue_of_dds_are_lost(robots, monkeypatch):
    """Names of the topic are lost since the last message, until the queue is empty."""
    from rvmon.adapters import dds

    monkeypatch.setattr(dds, "_DEPTH", 1)
    driver, gate, taken = Driver(robots.spec), threading.Event(), []

    class Slow(MessageFeed):
        def take(self, topic, content):
            taken.append(content)
            gate.wait(LONG)
            super().take(topic, content)

    kind, writer = robots.publisher("Float64")
    with dds.DdsSource(Slow(driver, robots.spec.schema), domain=robots.domain) as source:
        until(lambda: is_matched(writer.get_matched_subscriptions))
        # Messages sent before the reader knows its writer are not received.
        readers = source._readers
        until(lambda: any(is_matched(r.get_matched_publications) for r, _ in [*readers.values()]))
        writer.write(kind(data=0.5))
        until(lambda: taken)
        writer.write(kind(data=0.5))
        writer.write(kind(data=5.0))
        until(lambda: driver.waiting)  # the overflow
        gate.set()
        until(lambda: driver.waiting >= 3)
    assert driver.close()[""][0].verdicts == {"R": Verdict.INCONCLUSIVE}


@pytest.fixture
def linked(monkeypatch):
    """A stand-in for rospy with one connection and the answers of its master."""
    made = SimpleNamespace(socket=1, header={"callerid": "/robot"})
    link = SimpleNamespace(impl=SimpleNamespace(connections=[made]), master=lambda: None)

    def subscriber(topic, *_, **__):
        return SimpleNamespace(resolved_name=topic, impl=link.impl, unregister=int)

    monkeypatch.setitem(
        sys.modules,
        "rospy",
        SimpleNamespace(
            get_master=lambda: SimpleNamespace(getPid=int, getSystemState=lambda: link.master()),
            init_node=lambda *_, **__: None,
            Subscriber=subscriber,
            AnyMsg=None,
            signal_shutdown=str,
        ),
    )
    return link


@pytest.mark.parametrize("fault", ["a connection", "nonsense of the master", "rospy itself"])
def test_a_failure_of_the_connection_check_of_ros_1_is_a_loss(linked, fault, monkeypatch):
    """It is no longer known whether messages are lost, so they count as lost."""
    from rvmon.adapters.ros1 import Ros1Source

    monkeypatch.setattr("rvmon.adapters.ros1._TURN_S", 0.001)

    spec = loads(SPEC)
    driver = Driver(spec, clock=SimulatedClock())
    with Ros1Source(MessageFeed(driver, spec.schema)) as source:
        until(lambda: source._links)
        if fault == "rospy itself":
            linked.impl.connections = 7
        else:
            published = [["/base/speed", ["/robot"]]]
            is_there = 1, "", (published, [], [])
            linked.master = lambda: is_there if fault == "a connection" else ("", "", "no lists")
            linked.impl.connections = []
        until(lambda: driver.waiting)
    driver.offer({"base.speed": 0.5})
    driver.work()
    assert driver.close()[""][0].verdicts["R1"] is Verdict.INCONCLUSIVE


def test_rospy_that_is_missing_is_told(feed, monkeypatch):
    from rvmon.adapters.ros1 import Ros1Source

    monkeypatch.setitem(sys.modules, "rospy", None)
    with pytest.raises(RvmonError, match="python3-rospy"):
        Ros1Source(feed[0])


FLOAT = Topic("/base/speed", "std_msgs/msg/Float64", {"data": Kind.REAL})


@pytest.fixture
def feed():
    spec, clock = loads(SPEC), SimulatedClock()
    driver = Driver(spec, clock=clock)
    return MessageFeed(driver, spec.schema), driver, clock


def test_names_lead_to_the_topics_that_are_read(feed):
    assert set(feed[0].topics()) == {"/base/speed", "/base", "/stop"}


class Odd:
    """A message with a field that raises an unusual error."""

    @property
    def data(self):
        raise RuntimeError("it was taken from the pool")


@pytest.mark.parametrize("odd", [{"data": "fast"}, Odd()])
def test_a_message_that_does_not_fit_is_unknown(feed, odd):
    messages, driver, clock = feed
    messages.take(FLOAT, SimpleNamespace(data=0.5) if isinstance(odd, Odd) else {"data": 0.5})
    messages.take(FLOAT, odd)
    driver.work()
    clock.set_ns(10**9)
    messages.take(Topic("/stop", "std_msgs/msg/Empty", {}), {})
    driver.work()
    (report,) = driver.close()[""]
    assert report.verdicts["R1"] == "I"
    assert [one.name for one in report.health if one.kind == "dropped"] == ["base.speed"]


def test_a_topic_that_cannot_be_read_is_lost_for_good(feed):
    messages, driver, clock = feed
    messages.take(FLOAT, {"data": 0.5})
    messages.lose("/stop", "nobody knows its type", for_good=True)
    clock.set_ns(10**9)
    messages.take(FLOAT, {"data": 0.5})
    (report,) = driver.close()[""]
    lost = {one.name for one in report.health if one.kind == "dropped"}
    assert lost == {"stop"}
    assert {*report.verdicts.values()} == {"P", "I"}


def test_a_loss_before_a_message_starts_at_the_previous_one(feed):
    """Verdicts in between may be affected."""
    messages, driver, clock = feed
    messages.take(FLOAT, {"data": 0.5})
    for t in (1, 2):
        clock.set_ns(t * 10**9)
        messages.take(Topic("/stop", "std_msgs/msg/Empty", {}), {})
        driver.work()
    messages.lose("/base/speed", "some were lost", before=True)
    clock.set_ns(3 * 10**9)
    messages.take(FLOAT, {"data": 0.5})
    (report,) = driver.close()[""]
    assert report.verdicts["R1"] == "I"


def test_the_clock_follows_the_topic_of_that_name():
    """Time is known from its first message; a step back is a new run, and is reported."""
    spec, clock = loads(SPEC), SimulatedClock()
    driver = Driver(spec, clock=clock)
    messages = MessageFeed(driver, spec.schema, clock=clock)
    ticks = Topic("/clock", "rosgraph_msgs/msg/Clock", {})
    assert (messages.has_time, next(messages.topics())) == (False, "/clock")

    def tick(seconds):
        time = SimpleNamespace(sec=seconds, nanosec=5)
        messages.take(ticks, SimpleNamespace(clock=time))
        driver.work()

    tick(1000)
    assert messages.has_time
    messages.take(FLOAT, {"data": 2.0})
    tick(1001)
    tick(3)
    messages.take(FLOAT, {"data": 0.5})
    first, second = driver.close()[""]
    assert [one.decided for one in first.attempts] == [1000 * 10**9 + 5]
    assert (first.verdicts["R1"], second.verdicts["R1"]) == ("F", "P")


SIMULATOR = """
import time
import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Float64
rospy.init_node("simulator")
speed = rospy.Publisher("/speed", Float64, queue_size=10, latch=True)
obstacle = rospy.Publisher("/obstacle", Float64, queue_size=10, latch=True)
stop_request = rospy.Publisher("/stop_request", Bool, queue_size=10)
clock = rospy.Publisher("/clock", Clock, queue_size=10)
speed.publish(0.8)
obstacle.publish(0.4)
while not stop_request.get_num_connections():
    clock.publish(rospy.Time(1000))
    time.sleep(0.02)
clock.publish(rospy.Time(2000))
time.sleep(0.1)
stop_request.publish(True)
while not rospy.is_shutdown():
    time.sleep(0.1)
    clock.publish(rospy.Time(2001))
"""


@pytest.mark.process
def test_robots_of_a_simulator_use_its_clock(tmp_path, master):
    """`use_sim_time` of ROS 1: a deadline in simulated time, however slow the machine is."""
    pytest.importorskip("rosbags")
    environment = {"ROS_MASTER_URI": master, "ROS_IP": "127.0.0.1", "ROS_HOME": str(tmp_path)}
    told = ["/usr/bin/python3", "-c", "import rospy; rospy.set_param('/use_sim_time', True)"]
    subprocess.run(told, env={**os.environ, **environment}, check=True, timeout=LONG)  # noqa: S603
    talker = ["/usr/bin/python3", "-c", SIMULATOR]
    found = _failures(tmp_path, "ros1:", talker, environment)
    assert found == [("B1#1", "F"), ("B2#1", "F")]
