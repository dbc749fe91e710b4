"""Bags of ROS 1 and ROS 2, and the messages in them; needs rosbags, the extra `ros`."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import Any

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Message, Messages, Topic, by_name, errors_as_damage
from rvmon.recordings.messages.comments import comments_of
from rvmon.recordings.messages.field_meanings import plain_type
from rvmon.recordings.values import first_line
from rvmon.trace.schema import Kind

Definition = tuple[str, str]
"""The language of a definition (`msg` or `idl`), or the type that it defines, and its text."""

_FIXES = {
    "not indexed": "it was not closed: `rosbag reindex` closes it",
    "encryption": "it is encrypted: decrypt it first",
    "empty": "it is an empty file: record it again",
}
_FIX = {
    "ros1": "is it cut off? Copy it again, or try `rosbag reindex`",
    "ros2": "is it cut off? Copy it again, or try `ros2 bag reindex`",
}


class BagMessages(Messages):
    """An open bag: a `.bag`, `.db3` or `.mcap` file, or a folder of ROS 2."""

    def __init__(self, path: Path, form: str, definitions: Mapping[str, str]) -> None:
        self._form = form
        reader = bag_readers()[form]
        # The file itself is opened first: the system says why it cannot be.
        inner = path / "metadata.yaml" if path.is_dir() else path
        with open(inner, "rb"), bag_errors(self._form):
            self._reader = reader(path)
            self._reader.open()
        self.count = self._reader.message_count
        self.end = self._reader.end_time - 1 if self.count else None
        topics: list[Topic] = []
        self._decoders: dict[int, Callable[[bytes], Any]] = {}
        for connection in self._reader.connections:
            topic, decode = ros_topic(
                connection.topic,
                connection.msgtype,
                (connection.msgdef.format.name.lower(), connection.msgdef.data),
                self._form == "ros1",
                definitions,
                partial(self._first, connection),
            )
            topics.append(topic)
            self._decoders[connection.id] = decode
        self.topics = by_name(topics)

    def _first(self, connection: Any) -> bytes | None:
        with suppress(TraceError), bag_errors(self._form):  # who reads it all tells of damage
            for _, _, raw in self._reader.messages([connection]):
                return bytes(raw)
        return None

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """The messages of these topics, in the order in which they were recorded."""
        wanted = [
            connection for connection in self._reader.connections if connection.topic in topics
        ]
        if not wanted:
            return
        decoders = self._decoders
        with bag_errors(self._form):
            found = 0
            for connection, t, raw in self._reader.messages(wanted):
                found += 1
                try:
                    content = decoders[connection.id](raw)
                except MemoryError:
                    raise
                except Exception as error:  # noqa: BLE001 - code that was made of the definition
                    raise TraceError(
                        f"a message of {connection.topic} ({connection.msgtype}) at {t} ns does "
                        f"not fit its definition ({first_line(error)})"
                    ) from None
                yield connection.topic, t, content
        refuse_fewer(found, sum(one.msgcount for one in wanted))

    def close(self) -> None:
        """Close the files."""
        self._reader.close()


def refuse_fewer(found: int, counted: int) -> None:
    """Refuse a recording that lacks messages of those that are read."""
    if found < counted:
        raise TraceError(
            f"holds {found:,} messages of the topics that are read, and says itself that it has "
            f"{counted:,}: copy it again, or reindex it"
        )


@cache
def bag_readers() -> Mapping[str, Callable[[Path], Any]]:
    """The readers of bags, by form."""
    with needed("a bag", "rosbags"):
        from rosbags import rosbag1, rosbag2

    def ros2_reader(path: Path) -> Any:
        _refuse_unclosed(path)
        return rosbag2.Reader(path)

    return {"ros1": rosbag1.Reader, "ros2": ros2_reader}


def _refuse_unclosed(path: Path) -> None:
    """Refuse a bag of ROS 2 of which a part is in a file that no reader of bags looks at."""
    inner = [path]
    if path.is_dir():
        listed = (path / "metadata.yaml").read_text("utf-8", "replace")
        inner = sorted(one for one in path.iterdir() if one.suffix in (".db3", ".mcap"))
        if more := [one.name for one in inner if one.name not in listed]:
            raise TraceError(
                f"it was not closed: metadata.yaml does not list {more[0]}: `ros2 bag reindex` does"
            )
    for one in inner:
        for ending in ("-wal", "-journal"):
            rest = one.with_name(one.name + ending)
            if rest.exists() and rest.stat().st_size:
                raise TraceError(
                    f"it was not closed: a part of it is in {rest.name}, and would not be read: "
                    f"`sqlite3 {one.name} 'PRAGMA journal_mode = DELETE'` puts it in"
                )


def bag_errors(form: str) -> AbstractContextManager[None]:
    """Turns errors of the library into those of the bag."""
    return errors_as_damage("a bag", _FIX[form], _FIXES)


def ros_topic(
    name: str,
    type_name: str,
    definition: Definition,
    is_ros1: bool,
    others: Mapping[str, str],
    first: Callable[[], bytes | None] = lambda: None,
) -> tuple[Topic, Callable[[bytes], Any]]:
    """A topic of messages of ROS, and what decodes them.

    Without a text of its own the type has to be among the `others`, or one of ROS itself, whose
    definition has to fit the `first` message, if there is one.
    """
    if definition[1]:
        store, fault = _store(type_name, *definition)
    else:
        store, fault = _of_ros(type_name, tuple(sorted(others.items())), first)
    if fault or (fault := _lacking(store, type_name)):
        return Topic(name, type_name, {}, fault), bytes
    messages: dict[str, str] = {}
    leaves = dict(_leaves(store, type_name, messages))
    text = "" if definition[0] == "idl" else definition[1] or others.get(type_name, "")
    comments = dict(_comments(leaves, messages, comments_of(text)))
    unpack = store.deserialize_ros1 if is_ros1 else store.deserialize_cdr
    topic = Topic(name, type_name, leaves, messages=messages, comments=comments)
    return topic, lambda raw: unpack(raw, type_name)


@lru_cache(maxsize=512)
def _store(type_name: str, language: str, text: str) -> tuple[Any, str]:
    """The types that a definition names, or why there are none.

    The packages of many bags define the same messages: to prepare them takes longer than to read
    a small bag.
    """
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if language == "msg":
        parts = [partial(get_types_from_msg, text, type_name)]
    else:
        # Without the line that names a definition among others.
        texts = [re.sub(r"\AIDL: .*\n?", "", one) for one in text.split("=" * 80 + "\n")]
        parts = [partial(get_types_from_idl, one) for one in texts]
    store, why = _types("EMPTY", parts)
    if why:
        return None, f"the definition of its messages cannot be read ({why})"
    if type_name not in store.fielddefs:
        return None, "the definition of its messages is not in the recording"
    return store, ""


_UNDEFINED = (
    "the definition of its messages is neither in the recording nor one of ROS itself: name the "
    ".msg file, and those that it names, in a binding, as `definitions`"
)


_DISTRIBUTIONS = ("LATEST", "ROS2_HUMBLE", "ROS2_FOXY", "ROS2_DASHING")
"""The distributions in which messages of ROS itself changed, the newest first."""


def _of_ros(
    type_name: str, definitions: tuple[Definition, ...], first: Callable[[], bytes | None]
) -> tuple[Any, str]:
    """The types of the newest distribution whose definition fits the first message, or of all."""
    newest, fault = ros_types(definitions)
    if fault or type_name not in newest.fielddefs:
        return newest, fault or _UNDEFINED
    raw = None if type_name in dict(definitions) else first()
    for distribution in _DISTRIBUTIONS if raw is not None else ():
        store, _ = ros_types(definitions, distribution)
        with suppress(Exception):
            store.deserialize_cdr(raw, type_name)
            return store, ""
    return newest, ""


@lru_cache(maxsize=8)
def ros_types(
    definitions: tuple[Definition, ...], distribution: str = _DISTRIBUTIONS[0]
) -> tuple[Any, str]:
    """The types of ROS itself and these, by type and text; or why there are none."""
    from rosbags.typesys import get_types_from_msg

    parts = [partial(get_types_from_msg, text, name) for name, text in definitions]
    store, why = _types(distribution, parts)
    return store, why and f"the `definitions` of the binding cannot be read ({why})"


def _types(distribution: str, parts: Iterable[Callable[[], Any]]) -> tuple[Any, str]:
    """The types of a distribution, and what is read of definitions; or why these cannot be."""
    from rosbags.typesys import Stores, TypesysError, get_typestore

    store = get_typestore(Stores[distribution])
    try:
        types = {name: parsed for part in parts for name, parsed in part().items()}
        # The library makes classes by executing Python that it writes with these names in it. Its
        # grammar admits nothing that could be a statement, but names that are none of Python.
        for name, (constants, fields) in types.items():
            for part in (*name.split("/"), *(entry[0] for entry in (*constants, *fields))):
                if not (part.isascii() and part.isidentifier()):
                    return None, f"`{part}` is no name"
        store.register(types)
    except (TypesysError, KeyError, ValueError, TypeError) as error:
        return None, first_line(error)
    return store, ""


def _lacking(store: Any, type_name: str) -> str:
    """The types that a definition names and nobody defines, as a fault; empty: none."""
    from rosbags.interfaces import Nodetype

    known, waiting = {type_name}, [type_name]
    while waiting:
        for _, (node, inner) in store.fielddefs[waiting.pop()][1]:
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                node, inner = inner[0]
            if node is not Nodetype.NAME or inner in known:
                continue
            if inner not in store.fielddefs:
                return f"the definition of its messages names {inner}, and does not define it"
            known.add(inner)
            waiting.append(inner)
    return ""


def _comments(
    leaves: Iterable[str], messages: Mapping[str, str], comments: Mapping[str, Mapping[str, str]]
) -> Iterator[tuple[str, str]]:
    """The comments of a definition on fields, by path."""
    for path in (*messages, *leaves) if comments else ():
        above, _, field = path.rpartition(".")
        own = comments.get(plain_type(messages[above]) if above else "", {})
        if text := own.get(field.removesuffix("[]")):
            yield path, text


_FILLER = "structure_needs_at_least_one_member"  # the field of messages that have none

_KINDS = {"bool": Kind.BOOL, "string": Kind.LABEL, "wstring": Kind.LABEL, "wchar": Kind.LABEL}


def _leaves(
    store: Any,
    type_name: str,
    messages: dict[str, str],
    prefix: str = "",
    above: frozenset[str] = frozenset(),
) -> Iterator[tuple[str, Kind]]:
    """The fields that are no messages; the types of those that are go into `messages`."""
    from rosbags.interfaces import Nodetype

    for name, (node, inner) in store.fielddefs[type_name][1]:
        if name == _FILLER:
            continue
        path = f"{prefix}{name}"
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            path += "[]"
            node, inner = inner[0]
        if node is Nodetype.NAME:
            if inner not in above:
                messages[path] = inner
                yield from _leaves(store, inner, messages, f"{path}.", above | {type_name})
        else:
            base = inner[0]
            number = Kind.REAL if base.startswith("float") else Kind.INT
            yield path, _KINDS.get(base, number)
