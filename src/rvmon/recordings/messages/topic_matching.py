"""Matching of declared names with the topics and fields of a recording."""

from __future__ import annotations

import re
from collections.abc import Mapping

from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import expect_units, plain_type
from rvmon.recordings.messages.fields import (
    arrays_with_names,
    expect_kinds,
    field_of,
    refuse_whole,
)
from rvmon.trace.schema import Bound, Field, Kind, Schema, Term


def matched(
    schema: Schema, topics: Mapping[str, Topic]
) -> tuple[Mapping[str, Bound], tuple[str, ...]]:
    """Find the topic and field that feed each declared name.

    A column that the user mapped takes precedence over the binding, and the binding over the name
    itself. The name `a.b.c` means field `c` of topic `/a/b`, or field `b.c` of `/a`, or the element
    named `c` of the array `b` of `/a`. The name of a topic means its only field, if just one field
    is neither an array nor in the header.

    Returns:
        The sources by declared name, for topics that the recording has; and the topics and fields
        that feed no name.

    Raises:
        TraceError: a topic lacks the bound field, or the field is of another kind or unit, or the
            topic's messages cannot be read.
    """
    columns = _columns(topics)
    bounds: dict[str, Bound] = {}
    for name in (*schema.signals, *schema.events):
        bound = schema.binding.bounds.get(name)
        if bound is None or name in schema.columns:
            bound = _by_name(name, schema, columns, topics)
        if bound is not None and "*" in bound.topic:
            bound = replace(bound, topic=_topic_like(name, bound.topic, schema, topics))
        if bound is not None and bound.topic in topics:
            _expect_fit(name, bound, schema, topics[bound.topic])
            bounds[name] = bound
    read = {bound.topic for bound in bounds.values()}
    unread = [name for name in topics if name not in read]
    unread += [column for column, (topic, _) in columns.items() if column != topic]
    return bounds, tuple(unread)


def _topic_like(name: str, pattern: str, schema: Schema, topics: Mapping[str, Topic]) -> str:
    """The only topic that matches a pattern with `*`, or the pattern itself if none does.

    Raises:
        TraceError: several topics match, and the binding names no robot.
    """
    if schema.binding.robot:
        return pattern.replace("*", schema.binding.robot)
    like = re.escape(pattern).replace(r"\*", "[^/]+")
    found = [topic for topic in topics if re.fullmatch(like, topic)]
    if len(found) > 1:
        listed = ", ".join(found[:4]) + (", …" if len(found) > 4 else "")
        raise TraceError(
            f"`{name}` is bound to {pattern}, and there are {listed}: say which robot is meant, as "
            '`robot = "robot_1"` at the top of the binding'
        )
    return found[0] if found else pattern


def _columns(topics: Mapping[str, Topic]) -> dict[str, tuple[str, Field | None]]:
    """Topic and field by name: `TOPIC` with its only field or `None`, and `TOPIC.FIELD`.

    Elements of arrays are left out.
    """
    found: dict[str, tuple[str, Field | None]] = {}
    for topic in topics.values():
        leaves = [leaf for leaf in topic.leaves if "[" not in leaf]
        own = [leaf for leaf in leaves if not leaf.startswith("header.")]
        found[topic.name] = topic.name, field_of(own[0]) if len(own) == 1 else None
        for leaf in leaves:
            found[f"{topic.name}.{leaf}"] = topic.name, field_of(leaf)
    return found


def _by_name(
    name: str,
    schema: Schema,
    columns: Mapping[str, tuple[str, Field | None]],
    topics: Mapping[str, Topic],
) -> Bound | None:
    found = _place(schema.columns[name], columns, topics) if name in schema.columns else None
    if name not in schema.columns:
        found = next((place for one, place in columns.items() if dotted(one) == name), None)
        found = found or _element(name, topics)
    if name in schema.signals:
        if name in schema.columns and found is not None and found[1] is None:
            refuse_whole(topics[found[0]])
        return None if found is None or found[1] is None else Bound(*found)
    payload = schema.events[name]
    fields: dict[str, Term] = {}
    if found is not None:
        own = {column.removeprefix(f"{found[0]}."): place[1] for column, place in columns.items()}
        fields = {field: term for field in payload if (term := own.get(field)) is not None}
    for field in payload:
        mapped = _place(schema.columns.get(f"{name}.{field}", ""), columns, topics)
        if mapped is not None and mapped[1] is not None:
            found = found or (mapped[0], None)
            if mapped[0] == found[0]:
                fields[field] = mapped[1]
    if found is None:
        return None
    topic, value = found
    known = topics[topic]
    if str(value) not in known.doubtful and known.leaves.get(str(value)) is not Kind.BOOL:
        value = None  # each message is an occurrence
    return Bound(topic, value, fields)


def _element(name: str, topics: Mapping[str, Topic]) -> tuple[str, Field | None] | None:
    """The array element that a name means: for `a.b.c`, element `c` of the array `b` of `/a`."""
    for topic in topics.values():
        for array in arrays_with_names(topic):
            prefix = f"{dotted(topic.name)}.{array}."
            if name.startswith(prefix):
                return topic.name, field_of(f"{array}[{name.removeprefix(prefix)}]")
    return None


def dotted(column: str) -> str:
    """A topic or field, written as a name in a specification.

    >>> dotted("/base/odom.twist.linear.x")
    'base.odom.twist.linear.x'
    """
    return column.strip("/").replace("/", ".")


def _place(
    column: str, columns: Mapping[str, tuple[str, Field | None]], topics: Mapping[str, Topic]
) -> tuple[str, Field | None] | None:
    """The topic and field that a user named, maybe an array element; `None`: there is none."""
    if column in columns:
        return columns[column]
    for topic in sorted(topics, key=len, reverse=True):
        if column.startswith(f"{topic}."):
            field = field_of(column.removeprefix(f"{topic}."))
            return None if field is None else (topic, field)
    return None


def _expect_fit(name: str, bound: Bound, schema: Schema, topic: Topic) -> None:
    if topic.fault:
        raise TraceError(f"topic {topic.name} ({topic.type}), which feeds `{name}`: {topic.fault}")
    if bound.type and plain_type(bound.type) != plain_type(topic.type):
        raise TraceError(
            f"topic {topic.name}, which feeds `{name}`, holds {topic.type}, and the binding says "
            f"{bound.type}: is it the binding of another robot?"
        )
    if bound.value is not None:
        kind = schema.signals.get(name, Kind.BOOL)
        expect_kinds(name, kind, bound.value, bound.labels, topic)
    for field, term in bound.fields.items():
        expect_kinds(f"{name}.{field}", schema.events[name][field], term, {}, topic)
    expect_units(name, bound, schema, topic)
