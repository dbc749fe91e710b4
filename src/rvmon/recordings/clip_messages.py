"""Clipping of ROS bags and MCAP files, whose messages are copied byte for byte."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from rvmon.recordings.clip_piece import Copied, Piece
from rvmon.recordings.messages import Messages
from rvmon.recordings.messages.fields import stamp_getter
from rvmon.recordings.messages.file import open_messages
from rvmon.recordings.messages.mcap import mcap_errors
from rvmon.recordings.messages.ros import bag_errors, bag_readers
from rvmon.recordings.messages.topic_matching import matched
from rvmon.recordings.places import local_path
from rvmon.trace.schema import Bound, Clock

_Raw = tuple[str, Any, int, Any]
"""A message: topic, channel, ticks of its log stamp, and the library's object for it."""

_Read = Callable[[Collection[str] | None, int, int], Iterator[_Raw]]
"""Yields the messages of topics (`None`: all) from one instant up to another, exclusive."""

_KEPT_FOR_LATE = re.compile(r"durability:\s*(1\b|transient_local)")
"""In a ROS 2 quality of service: late subscribers get the last message, so the topic is latched."""


def clip_messages(path: str, form: str, piece: Piece, out: Path) -> Copied:
    """Write a piece of a recording of messages, and report what was copied.

    The piece is cut by log stamps. Where times are those of headers, the cut runs from the first to
    the last message whose header stamp lies in the piece. The last message before the start is
    put at the start for each topic that feeds a carried-in value, and for each latched topic.
    """
    place = local_path(path)
    with closing(open_messages(place, form, piece.schema)) as source:
        bounds, _ = matched(piece.schema, source.topics)
        recorded = _as_recorded(source, bounds, piece)
    happening = {bounds[name].topic for name in piece.schema.events if name in bounds}
    brought = {bounds[name].topic for name in piece.held} - happening
    clip = _clip_mcap if form == "mcap" else _clip_ros1 if form == "ros1" else _clip_ros2
    return clip(place, recorded, brought, happening, out)


def _as_recorded(source: Messages, bounds: Mapping[str, Bound], piece: Piece) -> Piece:
    """The piece with its start and stop as log stamps."""
    clocks = {bound.topic: bound.clock or piece.schema.binding.clock for bound in bounds.values()}
    stamped = [topic for topic, clock in clocks.items() if clock is Clock.HEADER]
    getters = {topic: stamp_getter(source.topics[topic]) for topic in stamped}
    logged = [piece.start, piece.stop] if len(stamped) < len(clocks) or not clocks else []
    for topic, t, content in source.read(stamped):
        if piece.holds(getters[topic](content)):
            logged.append(t)
    start, stop = (min(logged), max(logged)) if logged else (piece.start, piece.stop)
    return replace(piece, start=max(0, start), stop=stop)


def _chosen(
    read: _Read, piece: Piece, brought: Collection[str], latched: Collection[Any]
) -> Iterator[tuple[int, _Raw]]:
    """Yield the messages of a piece, each with the instant (ticks) at which it is written.

    For topics in `brought` and channels in `latched`, the last message before the piece is included
    and written at the start, unless there is one at the start anyway.
    """
    last: dict[Any, _Raw] = {}
    topics = {*brought, *(topic for topic, _ in latched)}
    for raw in read(topics, 0, piece.start) if topics else ():
        key = raw[:2] if raw[:2] in latched else raw[0]
        if key in brought or key in latched:
            last.pop(key, None)  # keeps `last` in the order of the messages
            last[key] = raw
    inside = read(None, piece.start, piece.stop + 1)
    first: list[_Raw] = []
    after = None
    for raw in inside:
        if raw[2] > piece.start:
            after = raw
            break
        first.append(raw)
    there = {key for raw in first for key in (raw[0], raw[:2])}
    yield from ((piece.start, raw) for key, raw in last.items() if key not in there)
    yield from ((raw[2], raw) for raw in first)
    if after is not None:
        yield after[2], after
    yield from ((raw[2], raw) for raw in inside)


def _copied(chosen: Iterator[tuple[int, _Raw]], write: Callable[[int, _Raw], object]) -> Copied:
    """Write messages, and count those that were not carried in."""
    copied = Copied()
    for t, raw in chosen:
        write(t, raw)
        if t == raw[2]:
            copied.note(t)
    return copied


def _clip_mcap(
    path: Path, piece: Piece, brought: Collection[str], happening: Collection[str], out: Path
) -> Copied:
    from rvmon.recordings.messages.mcap import mcap_reader

    with open(path, "rb") as file, open(out, "wb") as made, mcap_errors():
        reader = mcap_reader(file)
        from mcap.writer import Writer

        writer: Any = Writer(made)
        header = reader.get_header()
        writer.start(header.profile, header.library)
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        found = {channel.id: (schema, channel) for schema, channel in _channels(reader)}
        latched = {
            (channel.topic, channel.id)
            for _, channel in found.values()
            if _is_latched(channel.metadata) and channel.topic not in happening
        }
        schemas: dict[int, int] = {0: 0}
        channels: dict[int, int] = {}
        for schema, channel in found.values():
            if channel.schema_id not in schemas:
                own = writer.register_schema(schema.name, schema.encoding, schema.data)
                schemas[channel.schema_id] = own
            encoding, own = channel.message_encoding, schemas[channel.schema_id]
            channels[channel.id] = writer.register_channel(
                channel.topic, encoding, own, channel.metadata
            )

        def read(topics: Collection[str] | None, start: int, stop: int) -> Iterator[_Raw]:
            wanted = None if topics is None else list(topics)
            messages = reader.iter_messages(wanted, starting_at=start, ending_before=stop)
            for _, channel, message in messages:
                yield channel.topic, channel.id, message.log_time, message

        def write(t: int, raw: _Raw) -> None:
            message = raw[3]
            number = channels[message.channel_id]
            writer.add_message(number, t, message.data, message.publish_time, message.sequence)

        copied = _copied(_chosen(read, piece, brought, latched), write)
        writer.finish()
    return copied


def _channels(reader: Any) -> Iterator[tuple[Any, Any]]:
    """Yield schemas and channels; if the file has no index of them, by reading all messages."""
    summary = reader.get_summary()
    if summary is not None and summary.channels:
        for channel in summary.channels.values():
            yield summary.schemas.get(channel.schema_id), channel
    else:
        for schema, channel, _ in reader.iter_messages(log_time_order=False):
            yield schema, channel


def _is_latched(metadata: Mapping[str, str]) -> bool:
    profiles = metadata.get("offered_qos_profiles", "")
    return metadata.get("latching") == "1" or _KEPT_FOR_LATE.search(profiles) is not None


def _clip_ros1(
    path: Path, piece: Piece, brought: Collection[str], happening: Collection[str], out: Path
) -> Copied:
    from rosbags.rosbag1 import Writer

    return _clip_bag("ros1", path, piece, brought, happening, Writer(out))


def _clip_ros2(
    path: Path, piece: Piece, brought: Collection[str], happening: Collection[str], out: Path
) -> Copied:
    from rosbags.rosbag2 import StoragePlugin, Writer

    is_folder = path.is_dir()
    is_mcap = is_folder and any(path.glob("*.mcap*"))
    plugin = StoragePlugin.MCAP if is_mcap else StoragePlugin.SQLITE3
    # The library writes a folder; of a bag that is a database alone, only the database is kept.
    folder = out if is_folder else out.with_name(f"{out.name}.bag")
    writer = Writer(folder, version=9, storage_plugin=plugin)
    copied = _clip_bag("ros2", path, piece, brought, happening, writer)
    if not is_folder:
        next(folder.glob("*.db3")).replace(out)
    return copied


def _extra_of(form: str, connection: Any) -> tuple[dict[str, Any], bool]:
    """The arguments for copying a connection to a new bag, and whether its topic is latched."""
    own = connection.ext
    if form == "ros1":
        extra = {"md5sum": connection.digest, "callerid": own.callerid, "latching": own.latching}
        return extra, bool(own.latching)
    from rosbags.interfaces import QosDurability

    offered = own.offered_qos_profiles
    extra = {"rihs01": connection.digest, "serialization_format": own.serialization_format}
    is_latched = any(one.durability is QosDurability.TRANSIENT_LOCAL for one in offered)
    return {**extra, "offered_qos_profiles": offered}, is_latched


def _clip_bag(
    form: str,
    path: Path,
    piece: Piece,
    brought: Collection[str],
    happening: Collection[str],
    writer: Any,
) -> Copied:
    """Write a piece of a bag."""
    with bag_errors(form), bag_readers()[form](path) as reader, writer:
        latched = {
            (connection.topic, connection.id)
            for connection in reader.connections
            if connection.topic not in happening and _extra_of(form, connection)[1]
        }
        # Copy all connections in order: messages of one instant are read back in that order, and
        # topics without messages are kept. Connections that do not differ become one.
        alike: dict[Any, Any] = {}
        connections = {}
        for one in reader.connections:
            key = (one.topic, one.msgtype, one.digest, repr(one.ext))
            if key not in alike:
                extra, _ = _extra_of(form, one)
                alike[key] = writer.add_connection(
                    one.topic, one.msgtype, msgdef=one.msgdef.data, **extra
                )
            connections[one.id] = alike[key]

        def read(topics: Collection[str] | None, start: int, stop: int) -> Iterator[_Raw]:
            wanted = [
                connection
                for connection in reader.connections
                if topics is None or connection.topic in topics
            ]
            for connection, t, data in reader.messages(wanted, start, stop) if wanted else ():
                yield connection.topic, connection.id, t, (connection, data)

        def write(t: int, raw: _Raw) -> None:
            connection, data = raw[3]
            writer.write(connections[connection.id], t, data)

        return _copied(_chosen(read, piece, brought, latched), write)
