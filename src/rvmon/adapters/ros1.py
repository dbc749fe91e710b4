"""Live data and published verdicts of ROS 1; needs rospy of a ROS installation, and extra `ros`."""

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
"""Seconds between two checks of the connections; rospy reconnects without telling anybody."""


class Ros1Source:
    """A ROS 1 node that passes the messages of a feed's topics to it, within `with`.

    Connections carry the message definitions, so the packages of the types need not be installed.
    While the connection to an existing publisher is lost, the names that its topic feeds are
    unknown.

    Args:
        feed: receives the messages.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/String`; `None`:
            they are not published.

    Raises:
        RvmonError: rospy or rosbags is not installed.
    """

    def __init__(self, feed: MessageFeed, *, verdicts: str | None = None) -> None:
        self._rospy = _rospy()
        bag_readers()  # fails early, with the command that installs rosbags
        self._feed = feed
        self._verdicts = verdicts
        self._publisher: Any = None
        self._subscribers: list[Any] = []
        self._links: dict[tuple[str, str], Mapping[str, str]] = {}  # by topic and node
        self._down: set[tuple[str, str]] = set()
        self._stops = Event()
        self._watching = Thread(target=self._watch_connections, name="rvmon.ros1", daemon=True)
        self._decoders: dict[tuple[str, str], tuple[Topic, Callable[[bytes], Any]]] = {}

    def __enter__(self) -> Ros1Source:
        """Start the node.

        Raises:
            RvmonError: no master answers.
        """
        rospy = self._rospy
        try:
            rospy.get_master().getPid()
        except OSError as error:
            raise RvmonError(f"no ROS 1 master answers (ROS_MASTER_URI): {error}") from None
        rospy.init_node("rvmon", anonymous=True, disable_signals=True)
        if self._verdicts is not None:
            from std_msgs.msg import String

            self._publisher = rospy.Publisher(self._verdicts, String, queue_size=100)
        if self._feed.has_time:
            self._subscribe()
        else:
            # A topic can have only one type in a process, and rospy itself subscribes to this one.
            from rosgraph_msgs.msg import Clock

            self._subscribers.append(rospy.Subscriber(CLOCK, Clock, self._tick, tcp_nodelay=True))
        self._watching.start()
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
        header = message._connection_header  # rospy has no public way to the type of an AnyMsg
        key = topic, header["md5sum"]
        if key not in self._decoders:
            kind = header["type"].replace("/", "/msg/")
            text = header["message_definition"]
            self._decoders[key] = ros_topic(topic, kind, ("msg", text), True, {})
        known, decode = self._decoders[key]
        try:
            content = decode(message._buff)
        except Exception as error:  # noqa: BLE001 - raised by code generated from the definition
            self._feed.lose(topic, f"it does not fit its definition ({error})")
            return
        self._feed.take(known, content)

    def _watch_connections(self) -> None:
        with self._feed.receiving():
            while not self._stops.wait(_TURN_S):
                for subscriber in tuple(self._subscribers):
                    if subscriber.resolved_name != CLOCK:
                        self._check_connections(subscriber)

    def _check_connections(self, subscriber: Any) -> None:
        """Report an outage of a topic if one of its connections was lost or renewed."""
        topic = subscriber.resolved_name
        connections = tuple(subscriber.impl.connections or ())  # `None` once rospy has ended
        headers = [connection.header for connection in connections if connection.socket is not None]
        now = {header["callerid"]: header for header in headers if header and "callerid" in header}
        for name, node in [link for link in self._links if link[0] == topic]:
            link, header = (name, node), now.get(node)
            # Compared by identity: after a reconnection the header is a new, equal object.
            if header is self._links[link]:
                continue
            if link in self._down:
                if header is not None or not self._publishes(topic, node):
                    self._end_outage(link)
            elif header is not None:
                self._feed.lose(topic, f"{node} sent nothing for a while", before=True)
            elif self._publishes(topic, node):
                self._down.add(link)
                why = f"the connection to {node} is lost"
                self._feed.lose(topic, why, before=True, for_good=True)
            else:
                del self._links[link]
        self._links |= {(topic, node): header for node, header in now.items()}

    def _end_outage(self, link: tuple[str, str]) -> None:
        """Handle that a lost publisher is back or has left; the last one ends the outage."""
        del self._links[link]
        self._down.remove(link)
        if all(topic != link[0] for topic, _ in self._down):
            self._feed.find(link[0])

    def _publishes(self, topic: str, node: str) -> bool:
        """Whether the master lists a node as publisher of a topic; true if no master answers."""
        try:
            _, _, (publishers, _, _) = self._rospy.get_master().getSystemState()
        except Exception:  # noqa: BLE001 - no answer, or a malformed one
            return True
        return any(name == topic and node in nodes for name, nodes in publishers)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict; to be used as `on_judged` of a driver."""
        if self._publisher is not None:
            self._publisher.publish(judgement.to_json())

    def __exit__(self, *_: object) -> None:
        self._stops.set()
        self._watching.join()
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._rospy.signal_shutdown("rvmon ends")


def uses_sim_time() -> bool:
    """Whether ROS 1 nodes take the time from `/clock`, by the parameter `/use_sim_time`.

    Raises:
        RvmonError: rospy is not installed, or no master answers.
    """
    rospy = _rospy()
    try:
        return bool(rospy.get_param("/use_sim_time", False))
    except OSError as error:
        raise RvmonError(f"no ROS 1 master answers (ROS_MASTER_URI): {error}") from None


def _rospy() -> Any:
    try:
        import rospy
    except ImportError:
        raise RvmonError(
            "ROS 1 needs rospy, which is not installed: source the setup file of your ROS, or "
            "install python3-rospy and add its folder to PYTHONPATH"
        ) from None
    return rospy
