"""Live data of ROS 1, and verdicts back; needs rospy of a ROS installation, and the extra `ros`."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any

from rvmon.adapters.ros import RosSource
from rvmon.errors import RvmonError
from rvmon.readers.messages.ros import bag_readers, ros_topic
from rvmon.readers.messages.topic import Topic


class Ros1Source(RosSource):
    """A node of ROS 1.

    Messages bring their definition along: packages of their types need not be installed.

    Args:
        *given: as for `RosSource`.
        **options: as for `RosSource`.

    Raises:
        RvmonError: rospy or rosbags is not there.
    """

    def __init__(self, *given: Any, **options: Any) -> None:
        super().__init__(*given, **options)
        try:
            import rospy
        except ImportError:
            raise RvmonError(
                "ROS 1 needs rospy, which is not there: source the setup of your ROS, or install "
                "python3-rospy and add its folder to PYTHONPATH"
            ) from None
        bag_readers()  # says what to install
        self._rospy = rospy
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

            self._send = rospy.Publisher(self._verdicts, String, queue_size=100).publish
        self._subscribers = [
            rospy.Subscriber(topic, rospy.AnyMsg, self._take, callback_args=topic, tcp_nodelay=True)
            for topic in self._topics()
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
        self._hear(known, content)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._rospy.signal_shutdown("rvmon ends")
