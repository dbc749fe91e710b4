"""Live data and published verdicts of ROS 2 through a node of rclpy.

It has been tested only with a stub of rclpy, which was written from the sources of rclpy 8. To read
ROS 2 without installing it, see `rvmon.adapters.dds`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from threading import Thread
from typing import Any

from rvmon.adapters.messages import CLOCK, MessageFeed
from rvmon.errors import RvmonError
from rvmon.live.robot import Judgement
from rvmon.recordings.messages import Topic
from rvmon.trace.schema import Kind

_DEPTH = 1_000  # the most messages of a topic queued in the middleware
_TURN_S = 0.2  # seconds between two searches for newly published topics

_ARRAY = re.compile(r"sequence<(?P<of>.+?)(, \d+)?>|(?P<of_fixed>.+)\[\d+\]")
"""Matches `sequence<double>`, `sequence<double, 3>` and `double[9]`."""


class Ros2Source:
    """A ROS 2 node that passes the messages of a feed's topics to it, within `with`.

    Topics and their types are discovered when they are published; the packages of the types must be
    installed. A subscription is reliable if all publishers are, and latched if all publishers are.

    Args:
        feed: receives the messages; if it follows `/clock`, the node has `use_sim_time`.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/String`; `None`:
            they are not published.

    Raises:
        RvmonError: rclpy is not available.
    """

    def __init__(self, feed: MessageFeed, *, verdicts: str | None = None) -> None:
        try:
            import rclpy
        except ImportError:
            raise RvmonError(
                "ROS 2 needs rclpy, which is not installed: source the setup file of your ROS; or "
                "read dds:DOMAIN, which needs no ROS"
            ) from None
        self._rclpy = rclpy
        self._feed = feed
        self._verdicts = verdicts
        self._publisher: Any = None
        self._discovered: dict[str, set[str]] = {}  # by discovered topic, its types

    def __enter__(self) -> Ros2Source:
        """Start the node in its own thread, with an rclpy context apart from the program's."""
        from rclpy.clock import Clock, ClockType
        from rclpy.executors import SingleThreadedExecutor

        rclpy = self._rclpy
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        simulated = rclpy.Parameter("use_sim_time", value=CLOCK in self._feed.topics())
        self._node = rclpy.create_node(
            "rvmon", context=self._context, parameter_overrides=[simulated]
        )
        if self._verdicts is not None:
            from std_msgs.msg import String

            self._publisher = self._node.create_publisher(String, self._verdicts, 100)
        # The timer needs a steady clock, which runs even if no simulated time is published.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._node.create_timer(_TURN_S, self._find, clock=steady)
        self._find()
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = Thread(target=self._spin, name="rvmon.ros2", daemon=True)
        self._thread.start()
        return self

    def _spin(self) -> None:
        with self._feed.receiving():
            self._executor.spin()

    def _find(self) -> None:
        """Subscribe to the wanted topics that are published."""
        wanted = {*self._feed.topics()} if self._feed.has_time else {CLOCK}
        for name, types in self._node.get_topic_names_and_types():
            if name not in wanted or (known := self._discovered.get(name, set())) >= {*types}:
                continue
            publishers = self._node.get_publishers_info_by_topic(name)
            if not publishers:
                continue
            self._discovered[name] = known | {*types}
            if len(self._discovered[name]) > 1:
                several = ", ".join(sorted(self._discovered[name]))
                self._feed.lose(name, f"it has several types, {several}", for_good=True)
            else:
                self._subscribe(name, types[0], [publisher.qos_profile for publisher in publishers])

    def _subscribe(self, name: str, type_name: str, published: list[Any]) -> None:
        from rclpy.event_handler import SubscriptionEventCallbacks
        from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
        from rosidl_runtime_py.utilities import get_message

        try:
            kind = get_message(type_name)
            topic = Topic(name, type_name, dict(_leaves(kind)))
        except (ImportError, AttributeError, ValueError) as error:
            why = f"{error}: is the package of {type_name} installed?"
            self._feed.lose(name, why, for_good=True)
            return
        # A subscription that requests more than a publisher offers receives nothing.
        reliable, latched = ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL
        is_reliable = all(one.reliability == reliable for one in published)
        is_latched = all(one.durability == latched for one in published)
        qos = QoSProfile(
            depth=_DEPTH,
            reliability=reliable if is_reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=latched if is_latched else DurabilityPolicy.VOLATILE,
        )
        self._node.create_subscription(
            kind,
            name,
            lambda content: self._take(topic, content),
            qos,
            event_callbacks=SubscriptionEventCallbacks(
                message_lost=lambda _: self._feed.lose(
                    name, "earlier messages were lost", before=True
                ),
                incompatible_qos=lambda _: self._feed.lose(
                    name, "a publisher offers a weaker QoS than those before it", for_good=True
                ),
            ),
        )

    def _take(self, topic: Topic, content: Any) -> None:
        had_time = self._feed.has_time
        self._feed.take(topic, content)
        if not had_time:
            self._find()

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict; to be used as `on_judged` of a driver."""
        if self._publisher is not None:
            from std_msgs.msg import String

            self._publisher.publish(String(data=judgement.to_json()))

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown()
        self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()


_KINDS = {"boolean": Kind.BOOL, "float": Kind.REAL, "double": Kind.REAL}


def _leaves(kind: Any, prefix: str = "") -> Iterator[tuple[str, Kind]]:
    """The leaf fields of a message class with their kinds, as in `Topic.leaves`."""
    from rosidl_runtime_py.utilities import get_message

    for name, type_name in kind.get_fields_and_field_types().items():
        path, array = f"{prefix}{name}", _ARRAY.fullmatch(type_name)
        if array is not None:
            path, type_name = f"{path}[]", array["of"] or array["of_fixed"]
        if "/" in type_name:
            yield from _leaves(get_message(type_name.replace("/", "/msg/")), f"{path}.")
        else:
            yield path, Kind.LABEL if "string" in type_name else _KINDS.get(type_name, Kind.INT)
