"""A stand-in for rclpy, after the sources of rclpy 8: what `rvmon.adapters.ros2` uses of it.

Messages that a test publishes are handed to the subscriptions in the thread that spins.
"""

import queue
import sys
import types
from dataclasses import dataclass, field
from enum import IntEnum


class ReliabilityPolicy(IntEnum):
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(IntEnum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


@dataclass
class QoSProfile:
    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE

    @property
    def qos_profile(self):
        """A profile; it also serves as the information about its publisher."""
        return self


class ClockType(IntEnum):
    STEADY_TIME = 3


@dataclass
class Graph:
    """All nodes, the messages that tests publish, and the callbacks of nodes."""

    types: dict = field(default_factory=dict)  # by name: the class of messages
    publishers: dict = field(default_factory=dict)  # by topic: type, profiles
    subscriptions: dict = field(default_factory=dict)  # by topic: callback, profile, events
    parameters: dict = field(default_factory=dict)
    sent: list = field(default_factory=list)
    timers: list = field(default_factory=list)
    waiting: queue.SimpleQueue = field(default_factory=queue.SimpleQueue)

    def call(self, function, *args):
        """Let the spinning thread call a function, and wait for it."""
        done = queue.SimpleQueue()
        self.waiting.put(lambda: done.put(function(*args)))
        done.get(timeout=20)

    def publish(self, topic, **fields):
        """Publish a message to all subscriptions."""
        kind = self.types[self.publishers[topic][0]]
        self.call(self.subscriptions[topic][0], types.SimpleNamespace(**fields), kind)


class Node:
    """A node of the graph."""

    def __init__(self, graph, parameters):
        self.graph = graph
        graph.parameters |= {one.name: one.value for one in parameters}

    def create_publisher(self, msg_type, topic, qos_profile):
        publisher = types.SimpleNamespace()
        publisher.publish = lambda message: self.graph.sent.append((topic, message.data))
        return publisher

    def create_timer(self, timer_period_sec, callback, callback_group=None, clock=None):
        assert clock.clock_type is ClockType.STEADY_TIME
        self.graph.timers.append(callback)

    def get_topic_names_and_types(self):
        return [(topic, kind.split()) for topic, (kind, _) in self.graph.publishers.items()]

    def get_publishers_info_by_topic(self, topic_name):
        return self.graph.publishers[topic_name][1]

    def create_subscription(self, msg_type, topic, callback, qos_profile, *, event_callbacks=None):
        heard = lambda message, kind: callback(message) if kind is msg_type else None  # noqa: E731
        self.graph.subscriptions[topic] = heard, qos_profile, event_callbacks

    def destroy_node(self):
        self.graph.subscriptions.clear()


class Executor:
    """Calls waiting callbacks one after the other."""

    def __init__(self, graph):
        self._graph = graph

    def add_node(self, node):
        return True

    def spin(self):
        while (call := self._graph.waiting.get()) is not None:
            call()

    def shutdown(self, timeout_sec=None):
        self._graph.waiting.put(None)
        return True


def message(**fields):
    """A message class with fields of these types."""
    return type("Message", (), {"get_fields_and_field_types": classmethod(lambda _: fields)})


def install(monkeypatch):
    """Make `import rclpy` give the stand-in; returns its graph."""
    graph = Graph()

    def get_message(name):
        if name not in graph.types:
            raise ModuleNotFoundError(f"No module named '{name.split('/')[0]}'")
        return graph.types[name]

    class String:
        def __init__(self, *, data):
            self.data = data

    modules = {
        "rclpy": {
            "Context": lambda: types.SimpleNamespace(try_shutdown=lambda: None),
            "Parameter": lambda name, value: types.SimpleNamespace(name=name, value=value),
            "create_node": lambda *_, parameter_overrides, **__: Node(graph, parameter_overrides),
            "init": lambda **_: None,
        },
        "rclpy.clock": {"Clock": types.SimpleNamespace, "ClockType": ClockType},
        "rclpy.event_handler": {"SubscriptionEventCallbacks": types.SimpleNamespace},
        "rclpy.executors": {"SingleThreadedExecutor": lambda **_: Executor(graph)},
        "rclpy.qos": {
            "DurabilityPolicy": DurabilityPolicy,
            "QoSProfile": QoSProfile,
            "ReliabilityPolicy": ReliabilityPolicy,
        },
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.utilities": {"get_message": get_message},
        "std_msgs": {},
        "std_msgs.msg": {"String": String},
    }
    for name, content in modules.items():
        module = types.ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    return graph
