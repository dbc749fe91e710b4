"""Live data of ROS 2 over DDS, without a ROS installation; needs cyclonedds, the extra `dds`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any

from rvmon.adapters.messages import CLOCK, MessageFeed
from rvmon.errors import RvmonError, needed
from rvmon.live.robot import Judgement
from rvmon.readers.messages.ros import ros_topic, ros_types

if TYPE_CHECKING:
    from rvmon.readers.messages.topic import Topic

_DEPTH = 10_000
"""Messages of a topic that wait at most within DDS; one more is rejected, and reported as lost."""

_AT_ONCE = 1_000
"""Messages of a topic that are taken before another topic has its turn."""

_LONG_NS = 3_600_000_000_000

_PREFIX = "rt/"
"""Before the names of topics of ROS 2 on the wire."""


_MAKING = Lock()
"""A type is completed as its first topic is made: sources that do so at once break each other's."""


class DdsSource:
    """A participant that offers what the topics of a feed say, from `with` on.

    Topics are found as somebody publishes them. Their types are those of ROS itself, and those of
    the definitions.

    Args:
        feed: gets the messages.
        domain: of DDS, as `ROS_DOMAIN_ID` names it.
        definitions: of messages by type, as a binding has them.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/msg/String`;
            `None`: none are.

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
            import cyclonedds  # noqa: F401 - says what to install
        self._feed = feed
        self._domain = domain
        self._definitions = tuple(sorted((definitions or {}).items()))
        self._verdicts = verdicts
        self._writer: Any = None
        self._readers: dict[str, tuple[Any, Topic]] = {}
        self._types: dict[str, str] = {}  # on the wire, by topic, as it was published first
        self._found: set[str] = set()  # of these, those that are to be read
        self._given_up: set[str] = set()
        self._losses: dict[str, int] = {}  # by topic, until what waited then is taken
        self._lock = Lock()
        self._stops = False
        self._listeners: list[Any] = []  # nobody else holds them

    def __enter__(self) -> DdsSource:
        """Join the domain.

        Raises:
            RvmonError: that cannot be.
        """
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import DDSException, GuardCondition, WaitSet
        from cyclonedds.domain import DomainParticipant

        self._wanted = {topic.lstrip("/"): topic for topic in self._feed.topics()}
        try:
            self._participant = DomainParticipant(self._domain)
        except DDSException as error:
            raise RvmonError(f"domain {self._domain} of DDS cannot be joined: {error}") from None
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
        with self._feed.heard():
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
        except Exception as error:  # noqa: BLE001 - what others sent does not fit its type
            self._feed.lose(topic.name, f"cannot be unpacked ({error})", before=True)
        if losses is not None and len(taken) < _AT_ONCE:
            with self._lock:  # all that waited then is taken, if no more was lost since
                if self._losses[topic.name] == losses and name not in self._given_up:
                    del self._losses[topic.name]
                    self._feed.find(topic.name)

    def _wait_for(self, reader: Any) -> None:
        """Have the thread wake when there is something to be taken."""
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        anything = SampleState.Any | ViewState.Any | InstanceState.Any
        self._waiting.attach(ReadCondition(reader, anything))

    def _lose(self, topic: Topic) -> None:
        """Have a topic lost: what waits now was sent before, and ends no loss."""
        with self._lock:
            self._losses[topic.name] = self._losses.get(topic.name, 0) + 1
            self._feed.lose(topic.name, "DDS has lost some", before=True, for_good=True)
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
        """Read the topics that are wanted and published."""
        for one in self._finder.take(N=1_000):
            name = (getattr(one, "topic_name", None) or "").removeprefix(_PREFIX)  # none: it left
            if name not in self._wanted:
                continue
            if (known := self._types.setdefault(name, one.type_name)) != one.type_name:
                self._give_up(name, f"it has two types, {known} and {one.type_name}")
            elif name not in self._readers:
                self._found.add(name)
        ready = {one for one in self._found if self._feed.has_time or self._wanted[one] == CLOCK}
        self._found -= ready
        for name in ready:
            try:
                self._begin(name, self._types[name])
            except Exception as error:  # noqa: BLE001 - as above: the others go on
                self._give_up(name, str(error))

    def _give_up(self, name: str, why: str) -> None:
        """Have lost for good, once, what a topic feeds: of somebody nothing can be heard."""
        with self._lock:
            if name not in self._given_up:
                self._given_up.add(name)
                self._feed.lose(self._wanted[name], why, for_good=True)

    def _begin(self, name: str, wire_type: str) -> None:
        from cyclonedds.core import Listener, Policy, Qos
        from cyclonedds.sub import DataReader

        kind = wire_type.replace("::dds_::", "/").replace("::", "/").removesuffix("_")
        topic, _ = ros_topic(self._wanted[name], kind, ("msg", ""), False, dict(self._definitions))
        if topic.fault:
            self._give_up(name, f"{kind}: {topic.fault}")
            return
        # A history that keeps the last messages would replace others and report nothing.
        limits = Policy.ResourceLimits(_DEPTH, -1, -1)
        qos = Qos(Policy.Reliability.BestEffort, Policy.History.KeepAll, limits)
        wire = self._wire_topic(name, kind, self._definitions)
        # To be called for each message would hold up the thread of DDS that receives them, until
        # the socket drops some and nobody learns of it; a loss is rare.
        listener = Listener(
            on_sample_lost=lambda *_: self._lose(topic),
            on_sample_rejected=lambda *_: self._lose(topic),
            on_requested_incompatible_qos=lambda *_: self._give_up(
                name, "a publisher has another type, or other terms"
            ),
        )
        self._listeners.append(listener)
        reader = DataReader(self._participant, wire, qos=qos, listener=listener)
        self._readers[name] = reader, topic
        self._wait_for(reader)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict: to be called by a driver, as its `on_judged`."""
        if self._writer is not None:
            kind = _idl_type("std_msgs/msg/String", ())
            self._writer.write(kind(data=judgement.to_json()))

    def __exit__(self, *_: object) -> None:
        self._stops = True
        self._wake.set(True)
        self._thread.join()
        for reader, _topic in self._readers.values():
            reader.set_listener(None)  # one that is freed would be called: readers live on longer


@cache
def _idl_type(name: str, definitions: tuple[tuple[str, str], ...]) -> Any:
    """The class by which cyclonedds packs and unpacks messages of a type.

    Args:
        name: of the type, `package/msg/Name`.
        definitions: by type, those that are not of ROS itself.
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


_PLAIN = {"bool": bool, "string": str}
"""Types of ROS that cyclonedds calls otherwise."""
