"""Random messages of a shop, and writers in several formats."""

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.tools.bags import START, TYPES, Content, Sent, write_json_mcap, write_ros1, write_ros2

SHOP = """
spec shop
signal speed : real
signal ready : bool
signal count : int
signal mode  : {idle, busy}
event  go
event  pick(id: int, x: real)

requirement R1
  upon go
  then within 20 ms ready
requirement R2
  always (mode == busy -> speed < 1.2)
requirement R3
  upon pick
  then within 50 ms (ready and count > n)
  for each n in pick.id
"""
"""Reads what `sent_at_random` sends."""

HEADER = ["speed", "ready", "count", "mode", "go", "pick.id", "pick.x"]
"""Its columns."""


def sent_at_random(rng: Any, count: int) -> list[Sent]:
    """Messages of the first six topics; some at one instant."""
    sent: list[Sent] = []
    t = START
    for _ in range(count):
        t += rng.choice([0, 1, 1_000_003, 10_000_000])
        topic = rng.choice([*TYPES][:6])
        content: dict[str, Content] = {
            "/speed": {"data": rng.choice([0.0, 1.5, 0.1 + rng.random(), float("nan")])},
            "/ready": {"data": rng.random() < 0.5},
            "/count": {"data": rng.randrange(-3, 9)},
            "/mode": {"data": rng.choice(["idle", "busy"])},
            "/go": {},
            "/pick": {"id": rng.randrange(5), "x": rng.random()},
        }
        sent.append((topic, t, content[topic]))
    return sent


def write_csv(path: Path, sent: Sequence[Sent], header: Sequence[str]) -> Path:
    """The messages as rows, one for each."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, ["t_ns", *header])
        writer.writeheader()
        for topic, t, content in sent:
            name = topic.strip("/").replace("/", ".")
            cells: dict[str, Any] = {name: "1"} if not content else {}
            for field, value in content.items():
                cells[name if field == "data" else f"{name}.{field}"] = value
            writer.writerow({"t_ns": t, **cells})
    return path


def write_protobuf_mcap(path: Path, sent: Sequence[Sent]) -> Path:
    """An MCAP file of Protocol Buffers."""
    from mcap_protobuf.writer import Writer

    made = _protobuf_types()
    with path.open("wb") as file, Writer(file) as writer:
        for topic, t, content in sent:
            writer.write_message(topic, made[topic](**content), t, t)
    return path


def _protobuf_types() -> dict[str, Any]:
    from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto
    from google.protobuf.descriptor_pool import DescriptorPool
    from google.protobuf.message_factory import GetMessageClass

    kinds = FieldDescriptorProto
    fields = {
        "/speed": {"data": kinds.TYPE_DOUBLE},
        "/ready": {"data": kinds.TYPE_BOOL},
        "/count": {"data": kinds.TYPE_INT32},
        "/mode": {"data": kinds.TYPE_STRING},
        "/go": {},
        "/pick": {"id": kinds.TYPE_INT32, "x": kinds.TYPE_DOUBLE},
    }
    file = FileDescriptorProto(name="shop.proto", package="shop", syntax="proto3")
    for topic, own in fields.items():
        message = file.message_type.add(name=topic[1:].title())
        for number, (name, kind) in enumerate(own.items(), 1):
            message.field.add(name=name, number=number, type=kind, label=kinds.LABEL_OPTIONAL)
    pool = DescriptorPool()
    pool.Add(file)
    return {
        topic: GetMessageClass(pool.FindMessageTypeByName(f"shop.{topic[1:].title()}"))
        for topic in fields
    }


OF_MESSAGES: Mapping[str, Callable[..., Path]] = {
    "a.bag": write_ros1,
    "sqlite3": lambda path, sent: write_ros2(path, sent, "sqlite3"),
    "mcap": lambda path, sent: write_ros2(path, sent, "mcap"),
    "b.mcap": write_json_mcap,
    "c.mcap": write_protobuf_mcap,
}
"""What writes a recording, by its name."""
