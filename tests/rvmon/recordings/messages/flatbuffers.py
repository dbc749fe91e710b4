"""MCAP files of FlatBuffers with their binary schemas, written byte by byte."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from struct import pack
from typing import Any

from tests.tools.bags import Content, Sent, write_mcap

Slots = Mapping[int, Any]
"""Of a table, by the number of a field: a sign of `struct` and a number, a text, bytes of a vector
of numbers led by their count, a list of texts or tables, or a table."""

BASES = {"?": 2, "i": 7, "d": 12}
"""Base types of `reflection.fbs` by the signs of `struct`."""

KINDS = {bool: "?", int: "i", float: "d"}


def packed(root: Slots) -> bytes:
    """A buffer, without padding."""
    data = bytearray(4)
    data[:4] = pack("<I", _put(data, root))
    return bytes(data)


def _put(data: bytearray, value: Any) -> int:
    """Append a table, a text or a vector; returns where it starts."""
    if isinstance(value, bytes):
        data += value
        return len(data) - len(value)
    if isinstance(value, str):
        return _put(data, pack("<I", len(value.encode())) + value.encode() + b"\0")
    if isinstance(value, list):
        start = _put(data, pack("<I", len(value)) + bytes(4 * len(value)))
        for place, one in enumerate(value):
            _lead(data, start + 4 + 4 * place, one)
        return start
    offsets, inline, inner = {}, b"", {}
    for number, one in value.items():
        offsets[number] = 4 + len(inline)
        if isinstance(one, tuple):
            inline += pack(f"<{one[0]}", one[1])
        else:
            inner[4 + len(inline)] = one
            inline += bytes(4)
    count = max(value, default=-1) + 1
    table = [offsets.get(number, 0) for number in range(count)]
    _put(data, pack(f"<{2 + count}H", 4 + 2 * count, 4 + len(inline), *table))
    start = _put(data, pack("<i", 4 + 2 * count) + inline)
    for place, one in inner.items():
        _lead(data, start + place, one)
    return start


def _lead(data: bytearray, at: int, value: Any) -> None:
    data[at : at + 4] = pack("<I", _put(data, value) - at)


def schema_of(name: str, fields: Mapping[str, Any]) -> bytes:
    """The binary schema of a table with these fields, as `flatc` makes it.

    Args:
        name: of the table.
        fields: a value of each by name; a mapping is a table of its own.
    """
    objects: list[Slots] = []
    root = _object(name, fields, objects)
    return packed({0: objects, 4: objects[root]})


def _object(name: str, fields: Mapping[str, Any], objects: list[Slots]) -> int:
    described = []
    for number, (field, value) in enumerate(fields.items()):
        own: dict[int, Any] = {0: ("b", 13)}
        if type(value) in KINDS:
            own = {0: ("b", BASES[KINDS[type(value)]])}
        elif isinstance(value, Mapping):
            own = {0: ("b", 15), 2: ("i", _object(f"{name}.{field}", value, objects))}
        elif isinstance(value, list):
            own = {0: ("b", 14), 1: ("b", 12)}
        described.append({0: field, 1: own, 2: ("H", number), 3: ("H", 4 + 2 * number)})
    objects.append({0: name, 1: described})
    return len(objects) - 1


def message_of(fields: Mapping[str, Any]) -> Slots:
    """A message with these fields; zeros are omitted."""
    slots: dict[int, Any] = {}
    for number, value in enumerate(fields.values()):
        if type(value) in KINDS:
            if value != 0:
                slots[number] = (KINDS[type(value)], value)
        elif isinstance(value, Mapping):
            slots[number] = message_of(value)
        elif isinstance(value, list):
            slots[number] = pack(f"<I{len(value)}d", len(value), *value)
        else:
            slots[number] = value
    return slots


def write_flatbuffer_mcap(path: Path, sent: Sequence[Sent]) -> Path:
    """An MCAP file of FlatBuffers; the first message of a topic defines its fields."""

    def described(topic: str, content: Content) -> tuple[str, str, bytes]:
        name = f"shop.{topic.strip('/').title()}"
        return name, "flatbuffer", schema_of(name, content)

    return write_mcap(
        path, sent, "flatbuffer", described, lambda content: packed(message_of(content))
    )
