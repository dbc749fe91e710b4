"""Live data and published verdicts over MQTT; needs paho-mqtt (extra `mqtt`)."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from threading import Event
from typing import Any
from urllib.parse import unquote, urlsplit

from rvmon.adapters.json_objects import JsonObjects, decoded_object
from rvmon.errors import RvmonError, TraceError, needed
from rvmon.live.robot import Judgement

_log = logging.getLogger("rvmon.live.input")

_PORT = 1883
_DROPPED = "$SYS/broker/publish/messages/dropped"
"""The topic on which mosquitto publishes the number of dropped messages every ten seconds."""

_PATIENCE_S = 10.0  # seconds within which a broker has to answer


@dataclass(frozen=True, slots=True)
class Address:
    """The address of a broker, with the topics to read."""

    host: str
    port: int
    user: str  # empty if the broker needs none
    password: str  # empty if the broker needs none
    topics: str  # an MQTT filter; its first `+` stands for the name of the robot

    @property
    def prefix(self) -> int:
        """The number of leading levels of a topic that are not part of a name."""
        levels = self.topics.split("/")
        return len(levels) - (levels[-1] == "#")

    @property
    def robot(self) -> int | None:
        """The index of the topic level with the name of the robot; `None` if there is none."""
        levels = self.topics.split("/")
        return levels.index("+") if "+" in levels else None


def address_of(url: str) -> Address:
    """Parse `mqtt://USER:PASSWORD@HOST:PORT/TOPICS`.

    Raises:
        RvmonError: the address has another form.

    >>> address_of("mqtt://broker/robots/+/#")
    Address(host='broker', port=1883, user='', password='', topics='robots/+/#')
    """
    form = "expected mqtt://HOST/TOPICS, such as mqtt://localhost/robots/+/#"
    # `urlsplit` would take the `#` of a filter for the start of a fragment.
    parts = urlsplit(url.replace("#", "%23"))
    topics = unquote(parts.path[1:])
    levels = topics.split("/")
    try:
        port = parts.port or _PORT
    except ValueError:
        raise RvmonError(f"{url}: its port is not a number up to 65535: {form}") from None
    if parts.scheme != "mqtt" or not parts.hostname or not topics:
        raise RvmonError(f"{url}: {form}")
    if "#" in levels[:-1] or any(
        len(level) > 1 and ("+" in level or "#" in level) for level in levels
    ):
        raise RvmonError(f"{url}: in a filter, + stands for one level, # for all after the last /")
    user, password = unquote(parts.username or ""), unquote(parts.password or "")
    return Address(parts.hostname, port, user, password, topics)


class MqttSource:
    """An MQTT client that offers each message, a JSON object or value, within `with`.

    The levels of a topic after the filter's prefix become the first parts of the name: with
    `robots/+/#`, the message `0.3` under `robots/left/arm/speed` is `arm.speed` of the robot
    `left`, as is `{"speed": 0.3}` under `robots/left/arm`. If the connection is lost, all names are
    lost from the last message, as the connection may have broken right after it, until it is back.

    Args:
        objects: receives the messages.
        address: of the broker.
        verdicts: the topic prefix under which verdicts are published as JSON, each under the name
            of its requirement; `None`: they are not published.

    Raises:
        RvmonError: paho-mqtt is not installed.
    """

    def __init__(
        self, objects: JsonObjects, address: Address, *, verdicts: str | None = None
    ) -> None:
        with needed("MQTT", "paho-mqtt"):
            from paho.mqtt.client import Client
            from paho.mqtt.enums import CallbackAPIVersion
        self._objects = objects
        self._address = address
        self._verdicts = verdicts
        self._connected = Event()
        self._dropped: int | None = None
        self._counted_at = self._received = objects.driver.now_ns
        self._refusal = ""
        self._client = Client(CallbackAPIVersion.VERSION2)
        self._client.on_connect = self._on_connect
        self._client.on_subscribe = self._on_subscribe
        self._client.on_disconnect = self._on_disconnect
        self._client.on_message = self._on_message
        if address.user:
            self._client.username_pw_set(address.user, address.password)

    def __enter__(self) -> MqttSource:
        """Connect and subscribe.

        Raises:
            RvmonError: the broker cannot be reached or refuses.
        """
        where = f"{self._address.host}:{self._address.port}"
        try:
            self._client.connect(self._address.host, self._address.port)
        except OSError as error:
            raise RvmonError(f"no MQTT broker answers at {where}: {error}") from None
        self._client.loop_start()
        if not self._connected.wait(_PATIENCE_S) or self._refusal:
            self.__exit__()
            why = self._refusal or f"it did not answer in {_PATIENCE_S:.0f} s"
            raise RvmonError(f"the MQTT broker at {where} refuses: {why}")
        return self

    def _on_connect(self, client: Any, _: object, __: object, reason: Any, ___: object) -> None:
        if reason.is_failure:
            self._refusal = str(reason)
            self._connected.set()
        else:  # also when the connection is back after a loss
            # QoS 0: with QoS 1 a broker sends only as fast as messages are acknowledged, and drops
            # the rest. At 4,000 messages per second that is half of them.
            client.subscribe([(self._address.topics, 0), (_DROPPED, 0)])

    def _on_subscribe(self, _: object, __: object, ___: object, reasons: Any, ____: object) -> None:
        if reasons[0].is_failure:
            self._refusal = (
                f"the broker does not allow reading {self._address.topics} ({reasons[0]})"
            )
            _log.warning("the broker refuses: %s", self._refusal)  # an outage then goes on
        elif self._connected.is_set():  # not the first time: the outage ends
            self._objects.driver.found()
        self._received = self._objects.driver.now_ns
        self._connected.set()

    def _on_disconnect(self, _: object, __: object, ___: object, reason: Any, ____: object) -> None:
        self._dropped = None
        if reason.is_failure:
            why = "the connection to the broker is lost"
            _log.warning("%s (%s): published messages are lost until it is back", why, reason)
            self._objects.driver.lose(since_ns=self._received, why=why)

    def _on_message(self, _: object, __: object, message: Any) -> None:
        try:
            self.hear(message.topic, bytes(message.payload), is_old=message.retain)
        except Exception as error:  # noqa: BLE001 - it would end paho's thread
            self._objects.lose("a message", error, None)

    def hear(self, topic: str, payload: bytes, *, is_old: bool = False) -> None:
        """Offer a message; an old one was retained by the broker."""
        self._received = self._objects.driver.now_ns
        if topic == _DROPPED:
            self._take_count_of_drops(payload)
            return
        levels = topic.split("/")
        place = self._address.robot
        robot = "" if place is None else levels[place]
        try:
            content = decoded_object(payload)
            for name in reversed(levels[self._address.prefix :]):
                content = {name: content}
            self._objects.take(content, robot, is_old=is_old)
        except TraceError as error:
            self._objects.lose(f"a message of {topic}", error, robot)

    def _take_count_of_drops(self, payload: bytes) -> None:
        """Report an outage since the last count if the broker has dropped messages meanwhile."""
        count = int(payload) if payload.isdigit() else 0
        driver = self._objects.driver
        if self._dropped is not None and count > self._dropped:
            why = "the broker has dropped messages, to this or to other clients"
            _log.warning("%s: %d", why, count - self._dropped)
            driver.lose(since_ns=self._counted_at, is_over=True, why=why)
        self._dropped, self._counted_at = count, driver.now_ns

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict; to be used as `on_judged` of a driver."""
        if self._verdicts is not None:
            topic = f"{self._verdicts}/{judgement.attempt.requirement}"
            self._client.publish(topic, judgement.to_json(), qos=1)

    def __exit__(self, *_: object) -> None:
        self._client.disconnect()
        self._client.loop_stop()
