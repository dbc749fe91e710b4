"""Fields of messages: parsing of paths, checks against topics, and functions that read values."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from math import inf
from operator import attrgetter
from typing import Any, assert_never

from rvmon.errors import TraceError
from rvmon.recordings.messages import Topic
from rvmon.recordings.values import plain
from rvmon.texts import nearest, shorten
from rvmon.trace.sample import calculated
from rvmon.trace.schema import Applied, Constant, Elements, Field, Kind, Named, Step, Term

_STEP = re.compile(r"\.?([^\W\d]\w*)|\[(\d{1,9})\]|\[([^\[\]\s](?:[^\[\]]*[^\[\]\s])?)\]")

_ABSENT = object()

_SHOWN = 6  # the most fields that an error lists

_STAMPS = ("header.stamp", "stamp", "timestamp")
_PARTS = (("sec", "nanosec"), ("sec", "nsec"), ("secs", "nsecs"), ("seconds", "nanos"))


def field_of(text: str) -> Field | None:
    """Parse a path such as `pose.position.x`, `ranges[0]`, `position[elbow]`; `None`: malformed.

    >>> field_of("poses[0].x"), field_of("2x"), str(field_of("values[Battery level].value"))
    (Field(path=('poses', 0, 'x')), None, 'values[Battery level].value')
    """
    steps: list[Step] = []
    place = 0
    while place < len(text):
        found = _STEP.match(text, place)
        if found is None or (text[place] == ".") != (place > 0 and text[place] != "["):
            return None
        steps.append(found[1] or (int(found[2]) if found[2] else Named(found[3])))
        place = found.end()
    return Field(tuple(steps)) if steps and isinstance(steps[0], str) else None


def _fields_in(term: Term, sign: str = "") -> Iterator[tuple[Field | Elements, bool]]:
    """Yield the fields that a term reads, and whether `number` reads the text of each."""
    if isinstance(term, Field | Elements):
        yield term, sign == "number"
    elif isinstance(term, Applied):
        for arg in term.args:
            yield from _fields_in(arg, term.sign)


def kind_of(field: Field | Elements, topic: Topic) -> Kind | None:
    """The kind of a field's values; `None` if it is not known.

    Raises:
        TraceError: the topic has no such field, or it is an array or a message.
    """
    path = re.sub(r"\[[^\[\]]*\]", "[]", str(field))
    if not topic.leaves or path in topic.leaves:
        return None if path in topic.doubtful else topic.leaves.get(path)
    where = f"topic {topic.name} ({topic.type})"
    if f"{path}[]" in topic.leaves:
        raise TraceError(f"{where}: `{field}` is an array: name an element, such as `{field}[0]`")
    inner = [leaf for leaf in topic.leaves if leaf.startswith((f"{path}.", f"{path}[]."))]
    if inner:
        raise TraceError(f"{where}: `{field}` is a message: name a field of it: {_listed(inner)}")
    ends = [leaf for leaf in topic.leaves if leaf.endswith(f".{path}")]
    close = ends[0] if ends else nearest(path, topic.leaves)
    meant = f"did you mean `{close}`?" if close else f"there are {_listed(list(topic.leaves))}"
    raise TraceError(f"{where} has no field `{field}`: {meant}")


def refuse_whole(topic: Topic) -> None:
    """Refuse a topic as the value of a signal, if it has fields to choose from."""
    own = [leaf for leaf in topic.leaves if not leaf.startswith("header.")]
    if own:
        raise TraceError(
            f"topic {topic.name} ({topic.type}) is a message: name a field of it: {_listed(own)}"
        )


def _listed(leaves: list[str]) -> str:
    more = f" and {len(leaves) - _SHOWN} more" if len(leaves) > _SHOWN else ""
    return ", ".join(f"`{leaf}`" for leaf in leaves[:_SHOWN]) + more


def expect_kinds(
    name: str, kind: Kind, term: Term, labels: Mapping[str, str], topic: Topic
) -> None:
    """Check that the fields of a term can give values of a kind.

    Raises:
        TraceError: a field is missing, or its values are of another kind.
    """
    for field, is_text in _fields_in(term):
        found = kind_of(field, topic)
        if found is None or (is_text and found is Kind.LABEL):
            continue
        if is_text:
            raise TraceError(
                f"`{name}`: `{field}` of topic {topic.name} ({topic.type}) is not text, and "
                "`number` reads text: leave it out"
            )
        fix = ""
        if kind is Kind.LABEL and isinstance(term, Field):
            fits = bool(labels) or found is Kind.LABEL
            fix = ": name in a binding which `labels` its values stand for"
        else:
            fits = found is not Kind.LABEL
        if kind is Kind.BOOL and found is Kind.REAL and isinstance(term, Field):
            fits, fix = False, f": compare it in a binding, as `{field} > 0`"
        if not fits:
            holds = {Kind.LABEL: "text", Kind.REAL: "numbers"}.get(found, "whole numbers")
            raise TraceError(
                f"`{name}` is declared {kind}, and `{field}` of topic {topic.name} "
                f"({topic.type}) holds {holds}{fix}"
            )


def getter(term: Term) -> Get:
    """Make a function from the content of a message to the value of a term.

    The content is an object with attributes, or a mapping. The function raises `KeyError` if a
    field is missing. An element beyond the end of an array is `None` (unknown), and so is a result
    computed with it.
    """
    match term:
        case Constant(value=value):
            return lambda _: value
        case Field(path=path):
            step_by_step = by_names(path)
            if not all(isinstance(step, str) for step in path):
                return step_by_step
            at_once = attrgetter(".".join(map(str, path)))

            def field(content: Any) -> Any:
                if not isinstance(content, Mapping):
                    return at_once(content)
                try:
                    return step_by_step(content)
                except KeyError:
                    return _with_dots(content, path)

            return field
        case Elements(array=array):
            return getter(array)
        case Applied(operation=operation, args=(Field() | Elements() as read_from,), sign=sign) if (
            sign == "number" or isinstance(read_from, Elements)
        ):
            value_of = getter(read_from)
            return lambda content: None if (one := value_of(content)) is None else operation(one)
        case Applied(operation=operation, args=args):
            read = [getter(arg) for arg in args]
            return lambda content: _calculated(operation, [one(content) for one in read])
        case _:
            assert_never(term)


def _with_dots(content: Mapping[str, Any], path: Sequence[Step]) -> Any:
    """Read a field whose own name has dots, as is possible in JSON: `{"pose.x": 1}`."""
    for count in range(len(path), 0, -1):
        inner = content.get(".".join(map(str, path[:count])), _ABSENT)
        if count == len(path) and inner is not _ABSENT:
            return inner
        if isinstance(inner, Mapping):
            with suppress(KeyError):
                return _with_dots(inner, path[count:])
    raise KeyError(path)


def _calculated(operation: Callable[..., float], values: list[Any]) -> Any:
    known = [plain(value) for value in values]
    for value in known:
        if isinstance(value, str):
            raise TraceError(f"`{shorten(value)}` is not a number to calculate with")
        if value != value:
            return None
    if inf in known or -inf in known:  # sensors report infinity if nothing is in range
        with suppress(ValueError, ArithmeticError):
            result = operation(*known)
            return None if result != result else result
    return calculated(operation, *known)


def stamp_getter(topic: Topic) -> Callable[[Any], int]:
    """Make a function from the content of a message to its header stamp, in ticks.

    Raises:
        TraceError: messages of the topic have no header stamp.
    """
    for prefix in _STAMPS:
        for seconds, parts in _PARTS:
            if {f"{prefix}.{seconds}", f"{prefix}.{parts}"} <= topic.leaves.keys():
                read = [getter(Field((*prefix.split("."), one))) for one in (seconds, parts)]
                return lambda content: int(read[0](content)) * 1_000_000_000 + int(read[1](content))
    raise TraceError(
        f"topic {topic.name} ({topic.type}) has no header whose stamp could count: "
        'bind what it feeds with `clock = "log"`'
    )


Get = Callable[[Any], Any]

NAMES = ("name", "names", "joint_names", "dof_names", "interface_names", "interface_groups")
"""Arrays that name the elements of parallel arrays: their siblings, or arrays inside siblings."""

KEYS = ("name", "key", "child_frame_id", "joint_name", "hardware_id", "device_id", "id")
"""Fields that name the message which contains them."""

_LISTS = re.compile(rf"(^|\.)({'|'.join(NAMES)})\[\]$")


def arrays_of_names(topic: Topic) -> list[str]:
    """The arrays of a topic that name the elements of other arrays."""
    return [
        leaf
        for leaf, kind in topic.leaves.items()
        if kind is Kind.LABEL and leaf.count("[") == 1 and _LISTS.search(leaf)
    ]


def arrays_with_names(topic: Topic) -> dict[str, str]:
    """By array of numbers with named elements, the array of the names.

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
    """Make a function that follows a path step by step, to elements by index or by name.

    It raises `KeyError` if a message has no element of a name. That is no update, as the joints of
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
    """Find an element by name: by a parallel array of names, or by a field of the element.

    `above`: the messages around the elements, from the outermost on.
    """
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
    """A field of a message, or of a part of it, by name; `None` if it is missing."""
    if isinstance(content, Mapping):
        return content.get(name)
    return getattr(content, name, None)
