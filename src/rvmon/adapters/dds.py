"""Live data of ROS 2 over DDS without a ROS installation; needs cyclonedds (extra `dds`)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any

from rvmon.adapters.messages import CLOCK, MessageFeed
from rvmon.errors import RvmonError, needed
from rvmon.live.robot import Judgement
from rvmon.recordings.messages.ros import ros_topic, ros_types

if TYPE_CHECKING:
    from rvmon.recordings.messages import Topic

_DEPTH = 10_000
"""The most messages of a topic queued in DDS; further ones are rejected and reported as lost."""

_AT_ONCE = 1_000  # the most messages of a topic taken before the next topic has its turn

_LONG_NS = 3_600_000_000_000  # the wait is interrupted by `_wake` anyway

_PREFIX = "rt/"  # the prefix of the names of ROS 2 topics in DDS


_MAKING = Lock()
"""Guards the creation of topics, which completes a shared type and is not thread-safe."""


class DdsSource:
    """A DDS participant that passes the messages of a feed's topics to it, within `with`.

    Topics are discovered when they are published. Known types are those of ROS itself and of
    `definitions`.

    Args:
        feed: receives the messages.
        domain: the DDS domain, as in `ROS_DOMAIN_ID`.
        definitions: the texts of message definitions by type, as in a binding.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/msg/String`;
            `None`: they are not published.

    Raises:
        RvmonError: cyclonedds is not installed.
    """

    def __init__(
        self,
        feed: MessageFeed,
        *,
        domain: int = 0,
        definitions: Mapping[str, str] | None = None,
        verdicts: str | None = None,
    ) -> None:
        with needed("DDS", "cyclonedds"):
            import cyclonedds  # noqa: F401 - fails early, with the command that installs it
        self._feed = feed
        self._domain = domain
        self._definitions = tuple(sorted((definitions or {}).items()))
        self._verdicts = verdicts
        self._writer: Any = None
        self._readers: dict[str, tuple[Any, Topic]] = {}
        self._types: dict[str, str] = {}  # by topic, its type in DDS as first published
        self._pending: set[str] = set()  # discovered topics without a reader yet
        self._given_up: set[str] = set()
        self._losses: dict[str, int] = {}  # by topic, losses since its queue was last emptied
        self._lock = Lock()
        self._stops = False
        self._listeners: list[Any] = []  # keeps them alive: DDS does not

    def __enter__(self) -> DdsSource:
        """Join the domain.

        Raises:
            RvmonError: the domain cannot be joined.
        """
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import DDSException, GuardCondition, WaitSet
        from cyclonedds.domain import DomainParticipant

        self._wanted = {topic.lstrip("/"): topic for topic in self._feed.topics()}
        try:
            self._participant = DomainParticipant(self._domain)
        except DDSException as error:
            raise RvmonError(f"DDS domain {self._domain} cannot be joined: {error}") from None
        if self._verdicts is not None:
            self._writer = self._written(self._verdicts)
        self._finder = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._wake = GuardCondition(self._participant)
        self._waiting = WaitSet(self._participant)
        self._waiting.attach(self._wake)
        self._wait_for(self._finder)
        self._thread = Thread(target=self._drive, name="rvmon.dds", daemon=True)
        self._thread.start()
        return self

    def _drive(self) -> None:
        with self._feed.receiving():
            while not self._stops:
                self._waiting.wait(_LONG_NS)
                self._wake.set(False)
                for name, (reader, topic) in self._readers.items():
                    self._take(name, reader, topic)
                self._find()

    def _take(self, name: str, reader: Any, topic: Topic) -> None:
        losses, taken = self._losses.get(topic.name), []
        try:
            taken = reader.take(N=_AT_ONCE)
            for content in taken:
                if content.sample_info.valid_data:
                    self._feed.take(topic, content)
        except Exception as error:  # noqa: BLE001 - a sender's data may not fit its type
            self._feed.lose(topic.name, f"cannot be unpacked ({error})", before=True)
        if losses is not None and len(taken) < _AT_ONCE:
            with self._lock:  # the queue is empty: the outage ends, unless more was lost since
                if self._losses[topic.name] == losses and name not in self._given_up:
                    del self._losses[topic.name]
                    self._feed.find(topic.name)

    def _wait_for(self, reader: Any) -> None:
        """Wake the thread when the reader has data."""
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        anything = SampleState.Any | ViewState.Any | InstanceState.Any
        self._waiting.attach(ReadCondition(reader, anything))

    def _lose(self, topic: Topic) -> None:
        """Start an outage of a topic; messages already queued are older and do not end it."""
        with self._lock:
            self._losses[topic.name] = self._losses.get(topic.name, 0) + 1
            self._feed.lose(topic.name, "DDS has lost messages", before=True, for_good=True)
        self._wake.set(True)

    def _written(self, topic: str) -> Any:
        from cyclonedds.pub import DataWriter

        wire = self._wire_topic(topic.lstrip("/"), "std_msgs/msg/String", ())
        return DataWriter(self._participant, wire)

    def _wire_topic(self, name: str, kind: str, definitions: tuple[tuple[str, str], ...]) -> Any:
        from cyclonedds.topic import Topic as DdsTopic

        with _MAKING:
            return DdsTopic(self._participant, _PREFIX + name, _idl_type(kind, definitions))

    def _find(self) -> None:
        """Create readers for the wanted topics that are published."""
        for one in self._finder.take(N=1_000):
            # The entry of a publisher that left has no name.
            name = (getattr(one, "topic_name", None) or "").removeprefix(_PREFIX)
            if name not in self._wanted:
                continue
            if (known := self._types.setdefault(name, one.type_name)) != one.type_name:
                self._give_up(name, f"it has two types, {known} and {one.type_name}")
            elif name not in self._readers:
                self._pending.add(name)
        ready = {one for one in self._pending if self._feed.has_time or self._wanted[one] == CLOCK}
        self._pending -= ready
        for name in ready:
            try:
                self._subscribe(name, self._types[name])
            except Exception as error:  # noqa: BLE001 - one bad topic must not stop the others
                self._give_up(name, str(error))

    def _give_up(self, name: str, why: str) -> None:
        """Declare the names of a topic lost for good, once, as a publisher cannot be received."""
        with self._lock:
            if name not in self._given_up:
                self._given_up.add(name)
                self._feed.lose(self._wanted[name], why, for_good=True)

    def _subscribe(self, name: str, wire_type: str) -> None:
        from cyclonedds.core import Listener, Policy, Qos
        from cyclonedds.sub import DataReader

        kind = wire_type.replace("::dds_::", "/").replace("::", "/").removesuffix("_")
        topic, _ = ros_topic(self._wanted[name], kind, ("msg", ""), False, dict(self._definitions))
        if topic.fault:
            self._give_up(name, f"{kind}: {topic.fault}")
            return
        # KeepAll, because a bounded history would silently replace old messages.
        limits = Policy.ResourceLimits(_DEPTH, -1, -1)
        qos = Qos(Policy.Reliability.BestEffort, Policy.History.KeepAll, limits)
        wire = self._wire_topic(name, kind, self._definitions)
        # Listen to rare events only. A listener for each message would slow down the receiving
        # thread of DDS until the socket drops messages unnoticed.
        listener = Listener(
            on_sample_lost=lambda *_: self._lose(topic),
            on_sample_rejected=lambda *_: self._lose(topic),
            on_requested_incompatible_qos=lambda *_: self._give_up(
                name, "a publisher has another type or an incompatible QoS"
            ),
        )
        self._listeners.append(listener)
        reader = DataReader(self._participant, wire, qos=qos, listener=listener)
        self._readers[name] = reader, topic
        self._wait_for(reader)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict; to be used as `on_judged` of a driver."""
        if self._writer is not None:
            kind = _idl_type("std_msgs/msg/String", ())
            self._writer.write(kind(data=judgement.to_json()))

    def __exit__(self, *_: object) -> None:
        self._stops = True
        self._wake.set(True)
        self._thread.join()
        for reader, _topic in self._readers.values():
            reader.set_listener(None)  # readers outlive their listeners and would call freed ones


@cache
def _idl_type(name: str, definitions: tuple[tuple[str, str], ...]) -> Any:
    """The class with which cyclonedds serialises messages of a type.

    Args:
        name: of the type, `package/msg/Name`.
        definitions: (type, text) pairs of the types that ROS itself does not define.
    """
    from cyclonedds.idl import make_idl_struct, types
    from rosbags.interfaces import Nodetype

    def made(node: Any, inner: Any) -> Any:
        if node is Nodetype.NAME:
            return _idl_type(inner, definitions)
        if node is Nodetype.BASE:
            return _PLAIN.get(inner[0]) or getattr(types, inner[0])
        of, length = made(*inner[0]), inner[1]
        if node is Nodetype.ARRAY:
            return types.array[of, length]
        return types.sequence[of, length] if length else types.sequence[of]

    store, _ = ros_types(definitions)
    fields = {field: made(*kind) for field, kind in store.fielddefs[name][1]}
    package, _, short = name.rpartition("/")
    wire = f"{package.replace('/', '::')}::dds_::{short}_"
    return make_idl_struct(short, wire, fields)


_PLAIN = {"bool": bool, "string": str}  # ROS types with another name in cyclonedds
