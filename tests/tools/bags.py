"""Recordings of messages as the libraries of ROS, MCAP and Protocol Buffers write them."""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

Content = Mapping[str, Any]
Types = Mapping[str, str]
Sent = tuple[str, int, Content]
"""Topic, nanoseconds, fields by name."""

START = 1_700_000_000_000_000_000
"""The first instant of a recording, as bags have them: nanoseconds since 1970."""

TYPES = {
    "/speed": "std_msgs/msg/Float64",
    "/ready": "std_msgs/msg/Bool",
    "/count": "std_msgs/msg/Int32",
    "/mode": "std_msgs/msg/String",
    "/go": "std_msgs/msg/Empty",
    "/pick": "shop_msgs/msg/Pick",
    "/base/scan": "shop_msgs/msg/Scan",
    "/base/odom": "nav_msgs/msg/Odometry",
    "/odom": "nav_msgs/msg/Odometry",
    "/range": "sensor_msgs/msg/Range",
    "/stop": "std_msgs/msg/Bool",
    "/temp": "std_msgs/msg/Float64",
}
"""Of topics, what they hold."""

NONE: Types = {}

DEFINITIONS = {
    "shop_msgs/msg/Pick": "int32 id\nfloat64 x\n",
    "shop_msgs/msg/Scan": "std_msgs/Header header\nfloat32[] ranges\nuint8 state\n",
}
"""Of messages that ROS does not bring along."""


def drive(*, stops_in_s: float) -> list[Sent]:
    """A drive of the base of `examples/base.rv`, which is asked to stop after two seconds."""
    sent: list[Sent] = []
    for tick in range(500):
        t = START + tick * 10_000_000
        speed = 0.0 if tick >= 200 + 100 * stops_in_s else 0.25
        stamp = {"sec": t // 10**9, "nanosec": t % 10**9}
        twist = {"twist": {"linear": {"x": speed}}}
        sent.append(("/odom", t, {"header": {"stamp": stamp}, "twist": twist}))
        if tick % 5 == 0:
            near = 0.25 if 300 <= tick < 350 else 1.5
            sent.append(("/range", t, {"header": {"stamp": stamp}, "range": near}))
            sent.append(("/stop", t, {"data": tick >= 200}))
    return sent


_SHOP = """definitions = ["msgs/shop_msgs/msg/Pick.msg"]
[bind.speed]
topic = "/pick"
value = "x * 2"
[bind.go]
topic = "/go"
"""


def write_shop(folder: Path) -> None:
    """Write a ROS 2 recording `bag`, a binding `base.toml` and the definition of a message.

    Event `go` occurs at the start; signal `speed` is 2 for four seconds, then 0.2.
    """
    sent: list[Sent] = [("/go", START, {})]
    sent += [("/pick", START + t * 10**9, {"id": t, "x": 1.0 if t < 4 else 0.1}) for t in range(9)]
    write_ros2(folder / "bag", sent, "sqlite3")
    definition = folder / "msgs" / "shop_msgs" / "msg" / "Pick.msg"
    definition.parent.mkdir(parents=True)
    definition.write_text(DEFINITIONS["shop_msgs/msg/Pick"])
    (folder / "base.toml").write_text(_SHOP)


def write_ros1(
    path: Path, sent: Sequence[Sent], types: Types = TYPES, own: Types = NONE, compression: str = ""
) -> Path:
    """A bag of ROS 1."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores

    store = _store(Stores.ROS1_NOETIC, tuple(own.items()))
    writer = Writer(path)
    if compression:
        writer.set_compression(Writer.CompressionFormat[compression.upper()])
    return _write_ros(path, sent, writer, store, store.serialize_ros1, types, own)


def write_ros2(path: Path, sent: Sequence[Sent], plugin: str, version: Any = 9) -> Path:
    """A bag of ROS 2, a folder; the plugin is `sqlite3` or `mcap`."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores

    store = _store(Stores.LATEST)
    writer = Writer(path, version=version, storage_plugin=StoragePlugin[plugin.upper()])
    return _write_ros(path, sent, writer, store, store.serialize_cdr)


@lru_cache(maxsize=8)
def _store(which: Any, own: tuple[tuple[str, str], ...] = ()) -> Any:
    """The messages of a distribution, and these: what packs each is made once."""
    from rosbags.typesys import get_types_from_msg, get_typestore

    store = get_typestore(which)
    for name, text in {**DEFINITIONS, **dict(own)}.items():
        store.register(get_types_from_msg(text, name))
    return store


def _write_ros(
    path: Path,
    sent: Sequence[Sent],
    writer: Any,
    store: Any,
    pack: Callable[[Any, str], bytes],
    types: Types = TYPES,
    own: Types = NONE,
) -> Path:
    with writer:
        connections = {
            topic: writer.add_connection(
                topic, types[topic], **_definition(store, types[topic], own)
            )
            for topic in dict.fromkeys(topic for topic, _, _ in sent)
        }
        for topic, t, content in sent:
            message = _message(store, types[topic], content)
            writer.write(connections[topic], t, pack(message, types[topic]))
    return path


def _definition(store: Any, name: str, own: Types) -> Mapping[str, Any]:
    """The definition of a type: one of its own as it was written, with its comments."""
    if name not in own:
        return {"typestore": store}
    made, digest = store.generate_msgdef(name)
    parts = {part.split()[1]: part for part in made.split("=" * 80 + "\n")[1:]}
    lacking = [part for named, part in parts.items() if f"MSG: {named}\n" not in own[name]]
    return {"msgdef": ("=" * 80 + "\n").join([own[name], *lacking]), "md5sum": digest}


def _message(store: Any, name: str, content: Content) -> Any:
    """A message of which fields that are not given are zero."""
    from rosbags.interfaces import Nodetype

    values: dict[str, Any] = {}
    for field, (node, inner) in store.fielddefs[name][1]:
        given = content.get(field)
        if node is Nodetype.NAME:
            values[field] = _message(store, inner, given or {})
        elif node is Nodetype.BASE:
            zero = {"string": "", "bool": False}.get(inner[0], 0)
            values[field] = zero if given is None else given
        else:
            values[field] = _array(store, inner[0], inner[1], given or [])
    if name == "std_msgs/msg/Empty":
        values = dict.fromkeys(store.types[name].__dataclass_fields__.keys() - {"__msgtype__"}, 0)
    return store.types[name](**values)


def _array(store: Any, element: Any, size: int, given: Sequence[Any]) -> Any:
    import numpy as np
    from rosbags.interfaces import Nodetype

    node, inner = element
    if node is Nodetype.NAME:
        return [_message(store, inner, one) for one in given or [{}] * size]
    if inner[0] == "string":
        return [*given]
    return np.array(given or [0] * size, inner[0])


def write_json_mcap(
    path: Path,
    sent: Sequence[Sent],
    *,
    schemas: bool = True,
    encoding: str = "json",
    **options: Any,
) -> Path:
    """An MCAP file of JSON, or of MessagePack or CBOR."""
    kinds = {bool: "boolean", int: "integer", float: "number", str: "string"}

    def packed(content: Any) -> bytes:
        if encoding == "json":
            return json.dumps(content).encode()
        module = import_module("cbor2" if encoding == "cbor" else "msgspec.msgpack")
        made: bytes = (module.dumps if encoding == "cbor" else module.encode)(content)
        return made

    def described(topic: str, content: Content) -> tuple[str, str, bytes] | None:
        known = {name: kinds[type(one)] for name, one in content.items() if type(one) in kinds}
        properties = {name: {"type": kind} for name, kind in known.items()}
        schema = json.dumps({"type": "object", "properties": properties}).encode()
        return (topic, "jsonschema", schema) if schemas else None

    return write_mcap(path, sent, encoding, described, packed, **options)


def write_mcap(
    path: Path,
    sent: Sequence[Sent],
    encoding: str,
    described: Callable[[str, Content], tuple[str, str, bytes] | None],
    packed: Callable[[Content], bytes],
    **options: Any,
) -> Path:
    """An MCAP file; the first message of a topic says which fields it has.

    Args:
        path: of it.
        sent: its messages.
        encoding: of these.
        described: gives name, encoding and text of a schema, if there is one.
        packed: gives the bytes of a message.
        options: of the writer.
    """
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer: Any = Writer(file, **options)
        writer.start()
        channels: dict[str, int] = {}
        for topic, t, content in sent:
            if topic not in channels:
                schema = described(topic, content)
                number = 0 if schema is None else writer.register_schema(*schema)
                channels[topic] = writer.register_channel(topic, encoding, number)
            writer.add_message(channels[topic], t, packed(content), t)
        writer.finish()
    return path
