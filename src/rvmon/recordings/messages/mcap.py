"""Reader of MCAP files: those of ROS 2 by rosbags, others by mcap, the extra `mcap`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from functools import partial
from os import SEEK_END
from pathlib import Path
from struct import Struct
from typing import Any, BinaryIO
from zlib import crc32

import msgspec

from rvmon.errors import TraceError, needed
from rvmon.recordings.jsonl_rows import decoded
from rvmon.recordings.messages import Message, Messages, Topic, by_name, errors_as_damage
from rvmon.recordings.messages.flatbuffer import FlatBuffers
from rvmon.recordings.messages.ros import BagMessages, refuse_fewer, ros_topic
from rvmon.recordings.values import first_line
from rvmon.texts import shorten
from rvmon.trace.schema import Kind

_MAGIC = b"\x89MCAP0\r\n"

_FOOTER = Struct("<BQQQI8s")
"""Opcode, length, offsets of the summary and of its offset section, their checksum, the magic."""

_BEFORE_SUM = 25  # bytes of the footer before the checksum, which it covers, too

Decode = Callable[[bytes], Any]

_ROS = {"ros1msg": ("msg", True), "ros2msg": ("msg", False), "ros2idl": ("idl", False)}
"""By encoding of a schema, the language of the definition, and whether it is of ROS 1."""


def mcap_messages(path: Path, definitions: Mapping[str, str]) -> Messages:
    """Open a file; `definitions` has ROS definitions (text by type) that the file may lack.

    Raises:
        TraceError: the file is not an MCAP file, or damaged.
        RvmonError: a package is not installed.
        OSError: the file cannot be opened.
    """
    with open(path, "rb") as file:
        head = file.read(64)
    if not head:
        raise TraceError("is an empty file: record it again")
    if not head.startswith(_MAGIC):
        raise TraceError("is not an MCAP file: it does not start like one")
    _refuse_damaged_summary(path)
    # After the magic: opcode (1 byte), length (8), length of the profile (4), the profile.
    if head[17:21] == b"\4\0\0\0" and head[21:25] == b"ros2":
        found = BagMessages(path, "ros2", definitions)
        if all(not topic.fault for topic in found.topics.values()):
            return found
        found.close()
    return _OtherMessages(path, definitions)


def _refuse_damaged_summary(path: Path) -> None:
    """Raise `TraceError` if the summary (times and counts) does not match its checksum.

    The libraries do not check it.
    """
    with open(path, "rb") as file:
        footer = max(0, file.seek(0, SEEK_END) - _FOOTER.size)
        file.seek(footer)
        tail = file.read()
        if len(tail) < _FOOTER.size:
            return
        opcode, length, start, _, expected, _ = _FOOTER.unpack(tail)
        if (opcode, length) != (2, 20) or not 0 < start <= footer or expected == 0:
            return  # the file has no checksum, or is cut off, which reading reports
        file.seek(start)
        summary = file.read(footer + _BEFORE_SUM - start)
    if crc32(summary) != expected:
        raise TraceError("its summary is damaged: copy it again, or try `mcap recover`")


def mcap_reader(file: BinaryIO) -> Any:
    """The library's reader of an open MCAP file, for any encodings.

    Raises:
        RvmonError: mcap is not installed.
    """
    with needed("MCAP", "mcap"):
        from mcap.reader import NonSeekingReader, SeekingReader

    class Reader(SeekingReader):
        """A reader that ignores incomplete summaries, and always compares checksums.

        The library does not compare them in files without an index of chunks.
        """

        def get_summary(self) -> Any:
            found = super().get_summary()
            return found if found is not None and _is_complete(found) else None

        def iter_messages(self, *words: Any, **options: Any) -> Any:
            summary = self.get_summary()
            if summary is not None and summary.chunk_indexes:
                return super().iter_messages(*words, **options)
            file.seek(0)
            return NonSeekingReader(file, validate_crcs=True).iter_messages(*words, **options)

    return Reader(file, validate_crcs=True)


def _is_complete(summary: Any) -> bool:
    """Whether a summary has the channels and schemas of all messages that it counts."""
    counted = {one for chunk in summary.chunk_indexes for one in chunk.message_index_offsets}
    if summary.statistics is not None:
        counted |= summary.statistics.channel_message_counts.keys()
    schemas = {channel.schema_id for channel in summary.channels.values()} - {0}
    return bool(counted <= summary.channels.keys() and schemas <= summary.schemas.keys())


class _OtherMessages(Messages):
    """An open MCAP file with messages of any encodings; see `mcap_messages`."""

    def __init__(self, path: Path, definitions: Mapping[str, str]) -> None:
        self._definitions = definitions
        self._file = open(path, "rb")  # noqa: SIM115 - closed by `close`
        try:
            with mcap_errors():
                self._reader = mcap_reader(self._file)
                self._look()
        except BaseException:
            self._file.close()
            raise

    def _look(self) -> None:
        """Find the topics in the summary, or in all messages if there is none."""
        summary = self._reader.get_summary()
        statistics = None if summary is None else summary.statistics
        self._counted: Counter[str] = Counter()  # messages by topic, as the file counts them
        if summary is not None and statistics is not None:
            channels = [
                (summary.schemas.get(channel.schema_id), channel)
                for channel in summary.channels.values()
            ]
            self.count = statistics.message_count
            self.end = statistics.message_end_time if self.count else None
            for _, channel in channels:
                self._counted[channel.topic] += statistics.channel_message_counts.get(channel.id, 0)
        else:
            found = {}
            for schema, channel, message in self._reader.iter_messages(log_time_order=False):
                found[channel.id] = schema, channel
                self.count += 1
                self.end = max(self.end or 0, message.log_time)
            channels = list(found.values())
        made = {channel.id: self._topic(schema, channel) for schema, channel in channels}
        self._decoders = {number: decode for number, (_, decode) in made.items()}
        self.topics = by_name(topic for topic, _ in made.values())

    def _topic(self, schema: Any, channel: Any) -> tuple[Topic, Decode]:
        """The topic of a channel, and the function that decodes its messages."""
        name, encoding = channel.topic, channel.message_encoding
        type_name = schema.name if schema is not None else "no type"
        language = schema.encoding if schema is not None else ""
        if encoding in _OBJECTS:
            decode_object = partial(_object, _OBJECTS[encoding]())
            kinds = dict(self._object_leaves(schema, name, decode_object))
            leaves = {path: kind or Kind.REAL for path, kind in kinds.items()}
            doubtful = frozenset(path for path, kind in kinds.items() if kind is None)
            return Topic(name, type_name, leaves, doubtful=doubtful), decode_object
        if encoding in ("cdr", "ros1"):
            form, is_ros1 = _ROS.get(language, ("msg", encoding == "ros1"))
            text = schema.data.decode("utf-8", "replace") if schema is not None else ""
            type_name = type_name if type_name.count("/") != 1 else type_name.replace("/", "/msg/")
            return ros_topic(name, type_name, (form, text), is_ros1, self._definitions)
        if encoding == "protobuf" and language == "protobuf":
            decode = _protobuf(schema)
            return Topic(name, type_name, dict(_protobuf_leaves(decode(b"").DESCRIPTOR))), decode
        if encoding == "flatbuffer" and language == "flatbuffer":
            try:
                buffers = FlatBuffers(schema.data, type_name)
            except Exception as error:  # noqa: BLE001 - a damaged schema may raise anything
                fault = f"its binary schema cannot be read ({first_line(error)})"
                return Topic(name, type_name, {}, fault), bytes
            return Topic(name, type_name, buffers.leaves), buffers.decode
        known = "JSON, MessagePack, CBOR, Protocol Buffers, FlatBuffers, CDR or ROS 1"
        fault = f"its messages are encoded as `{shorten(encoding)}`: expected {known}"
        return Topic(name, type_name, {}, fault), bytes

    def _object_leaves(
        self, schema: Any, topic: str, decode: Decode
    ) -> Iterator[tuple[str, Kind | None]]:
        """Yield the fields of the first message, and those that the schema declares.

        Errors in them are ignored here: they matter only if the topic is read.
        """
        first = next(iter(self._reader.iter_messages(topics=[topic])), None)
        with suppress(TraceError, msgspec.DecodeError):
            if first is not None:
                yield from _found_leaves(decode(first[2].data), "")
        with suppress(TraceError, msgspec.DecodeError):
            if schema is not None and schema.encoding == "jsonschema":
                described = _object(_json, schema.data)
                yield from _described_leaves(described, "", 0)

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of these topics in order of log stamps."""
        found = 0
        with mcap_errors():
            for _, channel, message in self._reader.iter_messages(topics=list(topics)):
                found += 1
                try:
                    content = self._decoders[channel.id](message.data)
                except MemoryError:
                    raise
                except Exception as error:  # noqa: BLE001 - each decoder has its own exceptions
                    raise TraceError(
                        f"a message of {channel.topic} at {message.log_time} ns cannot be decoded "
                        f"({first_line(error)})"
                    ) from None
                yield channel.topic, message.log_time, content
        refuse_fewer(found, sum(self._counted[topic] for topic in topics))

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def mcap_errors() -> AbstractContextManager[None]:
    """Turn errors of the library into `TraceError`, with advice for an MCAP file."""
    return errors_as_damage("MCAP", "is it cut off? Copy it again, or try `mcap recover`")


def _json(data: bytes) -> Any:
    return decoded(data, msgspec.json.decode)


def _cbor() -> Decode:
    with needed("a message of CBOR", "cbor2"):
        from cbor2 import CBORDecodeError, loads

    def decode(data: bytes) -> Any:
        try:
            return loads(data)
        except CBORDecodeError as error:
            raise TraceError(f"it is not CBOR ({first_line(error)})") from None

    return decode


_OBJECTS: Mapping[str, Callable[[], Decode]] = {
    "json": lambda: _json,
    "msgpack": lambda: msgspec.msgpack.decode,
    "cbor": _cbor,
}
"""By encoding, the decoder of messages that are objects with fields by name."""


def _object(decode: Decode, data: bytes) -> Mapping[str, Any]:
    found = decode(data)
    if not isinstance(found, dict):
        raise TraceError(f"it is not an object: `{shorten(str(found))}`")
    return found


_DESCRIBED = dict(zip(("boolean", "integer", "number", "string"), Kind, strict=True))

_DEEPEST = 20  # deeper levels of a schema are ignored


def _described_leaves(
    schema: Mapping[str, Any], path: str, depth: int
) -> Iterator[tuple[str, Kind]]:
    """Yield path and kind of each field in a JSON schema; references are not followed."""
    form = schema.get("type")
    if isinstance(form, str) and form in _DESCRIBED:
        yield path, _DESCRIBED[form]
    if depth == _DEEPEST:
        return
    items, properties = schema.get("items"), schema.get("properties")
    if isinstance(items, dict):
        yield from _described_leaves(items, f"{path}[]", depth + 1)
    if isinstance(properties, dict):
        for name, inner in properties.items():
            if isinstance(inner, dict):
                yield from _described_leaves(inner, f"{path}.{name}".lstrip("."), depth + 1)


_FOUND = {bool: Kind.BOOL, int: Kind.REAL, float: Kind.REAL, str: Kind.LABEL}
"""The kinds of values; an integer counts as real, as the next message may have decimals."""


def _found_leaves(value: Any, path: str) -> Iterator[tuple[str, Kind | None]]:
    """Yield path and kind of each field of a message; `None` for null and for empty arrays."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _found_leaves(inner, f"{path}.{name}".lstrip("."))
    elif isinstance(value, list):
        yield from _found_leaves(value[0] if value else None, f"{path}[]")
    elif value is None or type(value) in _FOUND:
        yield path, _FOUND.get(type(value))


def _protobuf(schema: Any) -> Decode:
    with needed("a message of Protocol Buffers", "mcap-protobuf-support"):
        from mcap_protobuf.decoder import DecoderFactory
    decode = DecoderFactory().decoder_for("protobuf", schema)
    assert decode is not None, "it is of this encoding"
    return decode


def _protobuf_leaves(
    descriptor: Any, prefix: str = "", above: frozenset[str] = frozenset()
) -> Iterator[tuple[str, Kind]]:
    for field in descriptor.fields:
        path = f"{prefix}{field.name}{'[]' if field.is_repeated else ''}"
        if field.message_type is not None:
            if field.message_type.full_name not in above:
                inside = above | {descriptor.full_name}
                yield from _protobuf_leaves(field.message_type, f"{path}.", inside)
        elif field.cpp_type == field.CPPTYPE_BOOL:
            yield path, Kind.BOOL
        elif field.cpp_type in (field.CPPTYPE_DOUBLE, field.CPPTYPE_FLOAT):
            yield path, Kind.REAL
        else:
            is_text = field.cpp_type == field.CPPTYPE_STRING
            yield path, Kind.LABEL if is_text else Kind.INT
