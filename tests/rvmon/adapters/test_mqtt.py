"""MQTT with a real broker."""

import json
import socket
import threading
from contextlib import contextmanager

import pytest
from tests.tools.servers import LONG, Broker, missing, mosquitto, until

pytest.importorskip("paho.mqtt.client")
from paho.mqtt.client import CallbackAPIVersion, Client

from rvmon import RvmonError, Verdict, loads
from rvmon.adapters.json_objects import JsonObjects
from rvmon.adapters.mqtt import MqttSource, address_of
from rvmon.live import Driver, Live, SimulatedClock

SPEC = """
spec s
signal arm.speed : real
event stop
requirement R1
  always arm.speed <= 1
requirement R2
  upon stop
  then within 20 ms arm.speed == 0
"""


@pytest.fixture
def broker(tmp_path):
    if mosquitto() is None:
        missing("mosquitto")
    made = Broker(tmp_path)
    yield made
    made.stop()


@pytest.fixture
def publish(broker):
    """A function that publishes a text once the broker runs."""
    client = Client(CallbackAPIVersion.VERSION2)
    client.connect("127.0.0.1", broker.port)
    client.loop_start()
    yield lambda topic, text, **kept: client.publish(topic, text, qos=1, **kept)
    client.disconnect()
    client.loop_stop()


@contextmanager
def _heard(port, **callbacks):
    """A live monitor of a broker's messages, and the objects that it has read."""
    live = Live(loads(SPEC), **callbacks)
    objects = JsonObjects(live)
    with live, MqttSource(objects, address_of(f"mqtt://127.0.0.1:{port}/#")):
        yield live, objects


@pytest.mark.process
def test_messages_are_judged_by_robot_and_verdicts_come_back(broker, publish):
    """A value under a topic, an object above it, and an event; each robot separately."""
    heard = []
    listener = Client(CallbackAPIVersion.VERSION2)
    listener.on_message = lambda _, __, message: heard.append((message.topic, message.payload))
    listener.connect("127.0.0.1", broker.port)
    listener.subscribe("verdicts/#", qos=1)
    listener.loop_start()
    spec = loads(SPEC)
    live = Live(spec, on_judged=lambda one: source.publish(one))
    objects = JsonObjects(live)
    address = address_of(f"mqtt://127.0.0.1:{broker.port}/robots/+/#")
    source = MqttSource(objects, address, verdicts="verdicts")
    with live, source:
        publish("robots/left/arm/speed", "0.5")
        publish("robots/right/arm", '{"speed": 2, "heat": 3}')
        publish("robots/left", '{"stop": true}')
        until(lambda: len(heard) == 2)
        status = live.status()
    listener.disconnect()
    listener.loop_stop()
    assert status["right"].verdicts["R1"] is Verdict.FAIL
    assert status["left"].verdicts == {"R1": Verdict.NOT_TRIGGERED, "R2": Verdict.FAIL}
    assert objects.ignored == {"arm.heat": 1}
    assert sorted((topic, json.loads(text)["robot"]) for topic, text in heard) == [
        ("verdicts/R1", "right"),
        ("verdicts/R2", "left"),
    ]


@pytest.mark.process
def test_what_is_published_while_the_broker_is_away_is_unknown(broker, publish):
    failed = threading.Event()
    with _heard(broker.port, on_failure=lambda _: failed.set()) as (live, _):
        publish("arm", '{"speed": 0.5}')
        until(lambda: live.status()[""].samples == 1 if live.status() else False)
        broker.stop()
        until(lambda: live.status()[""].lost == 1)
        broker.start()
        while not failed.wait(0.1):
            publish("arm", '{"speed": 5}')
    (report,) = live.close()[""]
    assert report.verdicts["R1"] is Verdict.FAIL
    assert report.counts["R1"][Verdict.PASS] == 0


@pytest.mark.process
def test_a_message_that_is_no_json_is_lost_and_told(broker, publish):
    with _heard(broker.port) as (live, objects):
        publish("arm/speed", "0.5")
        publish("arm/speed", "fast!")
        until(lambda: objects.unread == 1)
    assert live.close()[""][0].verdicts["R1"] is Verdict.INCONCLUSIVE


def test_messages_dropped_by_the_broker_may_be_ours():
    """It reports the number over all clients; between two reports anything may be lost."""
    driver = Driver(loads(SPEC), clock=(clock := SimulatedClock()))
    source = MqttSource(JsonObjects(driver), address_of("mqtt://127.0.0.1:1/#"))
    source.hear("arm/speed", b"0.5")
    for t, dropped in ((1, b"7"), (2, b"7"), (3, b"9")):
        clock.set_ns(t * 10**9)
        source.hear("$SYS/broker/publish/messages/dropped", dropped)
        source.hear("arm/speed", b"0.5")
        driver.work()
    (report,) = driver.close()[""]
    assert report.verdicts == {"R1": "I", "R2": "I"}
    assert "dropped messages" in report.health[0].remark


@pytest.mark.process
def test_retained_messages_are_not_events(broker, publish):
    """The value of a signal holds; an event of some time ago does not occur now."""
    for topic, text in (("stop", "true"), ("arm/speed", "5")):
        publish(topic, text, retain=True).wait_for_publish(LONG)
    with _heard(broker.port) as (live, _):
        until(lambda: live.status() and live.status()[""].samples == 2)
    assert live.close()[""][0].verdicts == {"R1": "F", "R2": "NT"}


@contextmanager
def _answers(*answers):
    """The port of a broker that sends fixed answers after the second message of its client.

    Also returns the first bytes that it receives.
    """
    greeting = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer():
            with server.accept()[0] as one:
                greeting.append(one.recv(4096))
                one.sendall(b"\x20\x02\x00\x00")  # connected
                one.recv(4096)
                one.sendall(b"".join(answers))
                while one.recv(4096):
                    pass

        answering = threading.Thread(target=answer)
        answering.start()
        yield server.getsockname()[1], greeting
        answering.join(LONG)


@pytest.mark.parametrize("name", ["", "ann:s%20t@"])
def test_a_topic_without_permission_is_reported(name):
    """With and without a name and password."""
    driver = Driver(loads(SPEC), clock=SimulatedClock())
    with _answers(b"\x90\x04\x00\x01\x80\x00") as (port, greeting):
        address = address_of(f"mqtt://{name}127.0.0.1:{port}/arm/#")
        source = MqttSource(JsonObjects(driver), address)
        with pytest.raises(RvmonError, match="the broker does not allow reading arm/#"):
            source.__enter__()
        source.__exit__()
    assert greeting[0].endswith(b"\0\3ann\0\3s t") is bool(name)
    assert greeting[0][9] & 0xC0 == (0xC0 if name else 0)


def test_a_message_with_an_invalid_topic_is_lost():
    """Its topic is not text; later messages are received."""
    driver = Driver(loads(SPEC), clock=SimulatedClock())
    objects = JsonObjects(driver)
    good = b"\x30\x0c\x00\x09arm/speed1"
    answers = b"\x90\x04\x00\x01\x00\x00", good, b"\x30\x05\x00\x02\xff\xfe1", good
    with (
        _answers(*answers) as (port, _),
        MqttSource(objects, address_of(f"mqtt://127.0.0.1:{port}/#")),
    ):
        until(lambda: driver.waiting == 3)
    driver.work()
    assert objects.unread == 1
    assert driver.close()[""][0].verdicts["R1"] is Verdict.INCONCLUSIVE


def test_a_broker_that_is_not_there_is_told():
    with pytest.raises(RvmonError, match=r"answers at 127\.0\.0\.1:1"), _heard(1):
        pass


@pytest.mark.parametrize(
    "url", ["mqtt://host", "mqtt:///a", "http://host/a", "mqtt://host:99999/a", "mqtt://h/a/#/b"]
)
def test_a_wrong_address_is_told(url):
    with pytest.raises(RvmonError, match=r"mqtt://|behind the last"):
        address_of(url)
