"""Live data of ROS 1, and verdicts back; needs rospy of a ROS installation, and the extra `ros`."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any

import msgspec

from rvmon.adapters.messages import MessageFeed
from rvmon.errors import RvmonError
from rvmon.live.clock import SimulatedClock
from rvmon.live.robot import Judgement
from rvmon.readers.messages.ros import bag_readers, ros_topic
from rvmon.readers.messages.topic import Topic
from rvmon.trace.time import TICKS_PER_SECOND


class Ros1Source:
    """A node that offers what the topics of a feed say, from `with` on.

    Messages bring their definition along: packages of their types need not be installed.

    Args:
        feed: gets the messages.
        clock: follows `/clock`; `None`: the clock of the driver runs by itself.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/String`; `None`:
            none are.

    Raises:
        RvmonError: rospy or rosbags is not there.
    """

    def __init__(
        self,
        feed: MessageFeed,
        *,
        clock: SimulatedClock | None = None,
        verdicts: str | None = None,
    ) -> None:
        try:
            import rospy
        except ImportError:
            raise RvmonError(
                "ROS 1 needs rospy, which is not there: source the setup of your ROS, or install "
                "python3-rospy and add its folder to PYTHONPATH"
            ) from None
        bag_readers()  # says what to install
        self._rospy = rospy
        self._feed = feed
        self._clock = clock
        self._verdicts = verdicts
        self._publisher: Any = None
        self._subscribers: list[Any] = []
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
        topics = [*self._feed.topics(), *(["/clock"] if self._clock is not None else [])]
        self._subscribers = [
            rospy.Subscriber(topic, rospy.AnyMsg, self._take, callback_args=topic, tcp_nodelay=True)
            for topic in topics
        ]
        return self

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
        if topic == "/clock" and self._clock is not None:
            stamp = content.clock
            self._clock.set_ns(stamp.sec * TICKS_PER_SECOND + stamp.nanosec)
        else:
            self._feed.take(known, content)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict: to be called by a driver, as its `on_judged`."""
        if self._publisher is not None:
            self._publisher.publish(msgspec.json.encode(judgement.to_dict()).decode())

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._rospy.signal_shutdown("rvmon ends")
