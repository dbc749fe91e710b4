"""The kinds of values in a recording of messages."""

from __future__ import annotations

from rvmon.readers.messages.match import dotted
from rvmon.readers.recording import FileRecording, topics_of
from rvmon.starter.column import Shapes
from rvmon.starter.seen import Seen, shapes_seen
from rvmon.trace.schema import Kind, Schema


def message_shapes(path: str) -> Shapes:
    """Look at the topics of a bag or MCAP file, and at the texts in it.

    Args:
        path: of it.

    Raises:
        TraceError: it cannot be read.
    """
    kinds: dict[str, Kind] = {}
    events: list[str] = []
    left_out: dict[str, str] = {}
    for topic in topics_of(path).values():
        name = dotted(topic.name)
        leaves = {leaf: kind for leaf, kind in topic.leaves.items() if leaf[:7] != "header."}
        if topic.fault:
            left_out[name] = topic.fault
        elif not leaves:
            events.append(name)
        plain = [leaf for leaf in leaves if "[" not in leaf]
        for leaf, kind in leaves.items():
            if "[" in leaf:
                left_out[f"{name}.{leaf}"] = "an array: bind an element"
            else:
                kinds[name if len(plain) == 1 else f"{name}.{leaf}"] = kind
    seen = {name: Seen() for name in (*kinds, *events)}
    for name, kind in kinds.items():
        if kind is not Kind.LABEL:
            seen[name].kinds.add(kind)
    for name in events:
        seen[name].add_payload({})
    texts = {name: kind for name, kind in kinds.items() if kind is Kind.LABEL}
    if texts:
        for sample in FileRecording(path, Schema(texts, {}), ordered=False):
            for name, value in sample.values.items():
                seen[name].add(value)
    shapes = shapes_seen(seen)
    return Shapes(shapes.declared, {**shapes.left_out, **left_out})
