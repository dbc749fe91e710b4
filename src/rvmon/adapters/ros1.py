"""Live data of ROS 1, and verdicts back; needs rospy of a ROS installation, and the extra `ros`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from threading import Event, Thread
from typing import Any

from rvmon.adapters.messages import CLOCK, MessageFeed
from rvmon.errors import RvmonError
from rvmon.live.robot import Judgement
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.ros import bag_readers, ros_topic

_TURN_S = 0.2
"""Seconds between two looks at the connections: rospy makes lost ones anew, and tells nobody."""


class Ros1Source:
    """A node that offers what the topics of a feed say, from `with` on.

    Messages bring their definition along: packages of their types need not be installed. While the
    connection to a publisher is lost that has not left, what its topic feeds is unknown.

    Args:
        feed: gets the messages.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/String`; `None`:
            none are.

    Raises:
        RvmonError: rospy or rosbags is not there.
    """

    def __init__(self, feed: MessageFeed, *, verdicts: str | None = None) -> None:
        self._rospy = _rospy()
        bag_readers()  # says what to install
        self._feed = feed
        self._verdicts = verdicts
        self._publisher: Any = None
        self._subscribers: list[Any] = []
        self._links: dict[tuple[str, str], Mapping[str, str]] = {}  # by topic and node
        self._down: set[tuple[str, str]] = set()
        self._ends = Event()
        self._looking = Thread(target=self._look, name="rvmon.ros1", daemon=True)
        self._decoders: dict[tuple[str, str], tuple[Topic, Callable[[bytes], Any]]] = {}

    def __enter__(self) -> Ros1Source:
        """Begin the node.

        Raises:
            RvmonError: no master answers.
        """
        rospy = self._rospy
        try:
            rospy.get_master().getPid()
        except OSError as error:
            raise RvmonError(f"no master of ROS 1 answers (ROS_MASTER_URI): {error}") from None
        rospy.init_node("rvmon", anonymous=True, disable_signals=True)
        if self._verdicts is not None:
            from std_msgs.msg import String

            self._publisher = rospy.Publisher(self._verdicts, String, queue_size=100)
        if self._feed.has_time:
            self._subscribe()
        else:
            from rosgraph_msgs.msg import Clock  # rospy reads it, too: there is one type per topic

            self._subscribers.append(rospy.Subscriber(CLOCK, Clock, self._tick, tcp_nodelay=True))
        self._looking.start()
        return self

    def _subscribe(self) -> None:
        rospy = self._rospy
        self._subscribers += [
            rospy.Subscriber(topic, rospy.AnyMsg, self._take, callback_args=topic, tcp_nodelay=True)
            for topic in self._feed.topics()
            if topic != CLOCK
        ]

    def _tick(self, message: Any) -> None:
        had_time = self._feed.has_time
        self._feed.set_time(message.clock.secs, message.clock.nsecs)
        if not had_time:
            self._subscribe()

    def _take(self, message: Any, topic: str) -> None:
        header = message._connection_header  # rospy has no other way to the type of an AnyMsg
        key = topic, header["md5sum"]
        if key not in self._decoders:
            kind = header["type"].replace("/", "/msg/")
            text = header["message_definition"]
            self._decoders[key] = ros_topic(topic, kind, ("msg", text), True, {})
        known, decode = self._decoders[key]
        try:
            content = decode(message._buff)
        except Exception as error:  # noqa: BLE001 - code that was made of the definition
            self._feed.lose(topic, f"it does not fit its definition ({error})")
            return
        self._feed.take(known, content)

    def _look(self) -> None:
        with self._feed.heard():
            while not self._ends.wait(_TURN_S):
                for subscriber in tuple(self._subscribers):
                    if subscriber.resolved_name != CLOCK:
                        self._look_at(subscriber)

    def _look_at(self, subscriber: Any) -> None:
        """Have lost what a topic feeds where a connection of it was lost, or made anew."""
        topic = subscriber.resolved_name
        connections = tuple(subscriber.impl.connections or ())  # none: rospy has ended
        headers = [connection.header for connection in connections if connection.socket is not None]
        now = {header["callerid"]: header for header in headers if header and "callerid" in header}
        for name, node in [link for link in self._links if link[0] == topic]:
            link, header = (name, node), now.get(node)
            # By identity: after a reconnection the header is another object of equal content.
            if header is self._links[link]:
                continue
            if link in self._down:
                if header is not None or not self._publishes(topic, node):
                    self._end_of(link)
            elif header is not None:
                self._feed.lose(topic, f"{node} sent nothing for a while", before=True)
            elif self._publishes(topic, node):
                self._down.add(link)
                why = f"the connection to {node} is lost"
                self._feed.lose(topic, why, before=True, for_good=True)
            else:
                del self._links[link]
        self._links |= {(topic, node): header for node, header in now.items()}

    def _end_of(self, link: tuple[str, str]) -> None:
        """A publisher is heard again, or has left."""
        del self._links[link]
        self._down.remove(link)
        if all(topic != link[0] for topic, _ in self._down):
            self._feed.find(link[0])

    def _publishes(self, topic: str, node: str) -> bool:
        """Whether a node is listed as one that publishes a topic; it is if no master answers."""
        try:
            _, _, (publishers, _, _) = self._rospy.get_master().getSystemState()
        except Exception:  # noqa: BLE001 - nobody answers, or somebody else, or not in full
            return True
        return any(name == topic and node in nodes for name, nodes in publishers)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict: to be called by a driver, as its `on_judged`."""
        if self._publisher is not None:
            self._publisher.publish(judgement.to_json())

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._looking.join()
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._rospy.signal_shutdown("rvmon ends")


def uses_sim_time() -> bool:
    """Whether nodes of ROS 1 are set to take the time of `/clock`, by the parameter of that name.

    Raises:
        RvmonError: rospy is not there, or no master answers.
    """
    rospy = _rospy()
    try:
        return bool(rospy.get_param("/use_sim_time", False))
    except OSError as error:
        raise RvmonError(f"no master of ROS 1 answers (ROS_MASTER_URI): {error}") from None


def _rospy() -> Any:
    try:
        import rospy
    except ImportError:
        raise RvmonError(
            "ROS 1 needs rospy, which is not there: source the setup of your ROS, or install "
            "python3-rospy and add its folder to PYTHONPATH"
        ) from None
    return rospy
