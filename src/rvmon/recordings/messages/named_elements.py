"""Elements of arrays by their names: joints, keys, frames."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rvmon.errors import TraceError
from rvmon.recordings.messages.topic import Topic
from rvmon.texts import shorten
from rvmon.trace.schema import Field, Kind, Named, Step

Get = Callable[[Any], Any]

NAMES = ("name", "names", "joint_names", "dof_names", "interface_names", "interface_groups")
"""Arrays that name the elements of those beside them, or below what is beside them."""

KEYS = ("name", "key", "child_frame_id", "joint_name", "hardware_id", "device_id", "id")
"""Fields that name the message that they are in."""

_LISTS = re.compile(rf"(^|\.)({'|'.join(NAMES)})\[\]$")


def arrays_of_names(topic: Topic) -> list[str]:
    """The arrays of a topic whose elements name those of others."""
    return [
        leaf
        for leaf, kind in topic.leaves.items()
        if kind is Kind.LABEL and leaf.count("[") == 1 and _LISTS.search(leaf)
    ]


def arrays_with_names(topic: Topic) -> dict[str, str]:
    """The arrays of numbers whose elements have names, with the array of these.

    >>> leaves = {"name[]": Kind.LABEL, "position[]": Kind.REAL}
    >>> arrays_with_names(Topic("/joints", "sensor_msgs/msg/JointState", leaves))
    {'position': 'name[]'}
    """
    holders = {names.rpartition(".")[0]: names for names in arrays_of_names(topic)}
    found: dict[str, str] = {}
    for leaf, kind in topic.leaves.items():
        array = leaf.removesuffix("[]")
        parent = array
        while kind is not Kind.LABEL and leaf.endswith("[]") and "[" not in array and parent:
            parent = parent.rpartition(".")[0]
            if parent in holders:
                found[array] = holders[parent]
                break
    return found


def by_names(path: tuple[Step, ...]) -> Get:
    """A function that goes a path step by step, to elements by their place or their name.

    It raises `KeyError` where a message has none of that name, which is then no update: joints of
    an arm and those of its hand often share a topic.
    """

    def read(content: Any) -> Any:
        above: list[Any] = []
        value = content
        is_mapping = isinstance(content, Mapping)
        try:
            for step in path:
                if isinstance(step, str):
                    above.append(value)
                    value = value[step] if is_mapping else getattr(value, step)
                elif isinstance(step, Named):
                    value = _named(above, value, step.name)
                else:
                    value = value[step]
        except IndexError:
            return None
        except (TypeError, AttributeError):
            shown = shorten(str(content))
            raise TraceError(f"there is no `{Field(path)}` in `{shown}`") from None
        return value

    return read


def _named(above: list[Any], elements: Sequence[Any], name: str) -> Any:
    """The element of that name, by names beside it or beside what is above it, or by its own."""
    for holder in reversed(above):
        for key in NAMES:
            names = part_of(holder, key)
            if isinstance(names, list | tuple) and names is not elements:
                if name not in names:
                    raise KeyError(name)
                place = names.index(name)
                return elements[place] if place < len(elements) else None
    for element in elements:
        if any(part_of(element, key) == name for key in KEYS):
            return element
    raise KeyError(name)


def part_of(content: Any, name: str) -> Any:
    """The field of a message, or of a part of one, by name; `None` if it has none."""
    if isinstance(content, Mapping):
        return content.get(name)
    return getattr(content, name, None)
