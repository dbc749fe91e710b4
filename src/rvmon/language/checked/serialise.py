"""Converts checked specifications to plain data and back, and to a text that identifies them.

Reading creates only objects of the classes of a checked specification, and executes nothing.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from enum import Enum
from functools import cache, partial
from typing import Any

from rvmon import diagnostics
from rvmon.diagnostics import Source, Span
from rvmon.language.checked import formula, properties, specification
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.operators import BinaryOp, Interval, UnaryOp
from rvmon.language.checked.window_measures import Measured
from rvmon.trace.schema import Kind


@cache
def _classes() -> Mapping[str, type]:
    """The classes of checked specifications and their warnings, by name."""
    classes: list[type] = [Measured, NumericOp, UnaryOp, BinaryOp, Interval, Kind]
    for module in (formula, specification, properties, diagnostics):
        own = (one for one in vars(module).values() if isinstance(one, type))
        classes += (one for one in own if one.__module__ == module.__name__)
    return {one.__name__: one for one in classes}


def to_plain(value: Any) -> Any:
    """A value as lists, numbers and texts; the text of each source is stored once.

    Raises:
        TypeError: a part of the value is of a class that specifications do not have.

    >>> from_plain(to_plain((1, "a", None))) == (1, "a", None)
    True
    """
    sources: dict[int, int] = {}
    return _to_plain(value, sources)


def _to_plain(value: Any, sources: dict[int, int]) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, Source):
        if id(value) in sources:
            return ["same", sources[id(value)]]
        sources[id(value)] = len(sources)
    name = type(value).__name__
    if isinstance(value, Enum) and _classes().get(name) is type(value):
        return [name, value.name]
    class_: Any = type(value)
    names = _attributes(class_)
    if names is not None:
        return [name, *[_to_plain(getattr(value, name), sources) for name in names]]
    if isinstance(value, Mapping):
        return ["dict", *(_to_plain(pair, sources) for pair in value.items())]
    if type(value) in (tuple, frozenset):
        return [name, *(_to_plain(one, sources) for one in value)]
    raise TypeError(f"a {name} is no part of a specification")


def from_plain(data: Any) -> Any:
    """The value that `to_plain` converted.

    Raises:
        ValueError, LookupError, TypeError: the data were not made by `to_plain`.
    """
    return _from_plain(data, [])


def _from_plain(data: Any, sources: list[Source]) -> Any:
    if type(data) is not list:
        return data
    name, *rest = data
    if name == "same":
        return sources[rest[0]]
    values = [_from_plain(one, sources) if type(one) is list else one for one in rest]
    match name:
        case "dict":
            return dict(values)
        case "tuple":
            return tuple(values)
        case "frozenset":
            return frozenset(values)
    class_ = _classes().get(name)
    if class_ is None:
        raise LookupError(f"no class `{name}`")
    if issubclass(class_, Enum):
        return class_[rest[0]]
    restored = class_(*values)
    if isinstance(restored, Source):
        sources.append(restored)
    return restored


def identity_text(spec: specification.CheckedSpec, *, without: Collection[str] = ()) -> str:
    """A text that is equal for specifications that differ only in places in files.

    It is the same in all processes. Attributes named in `without` are left out.
    """
    return json.dumps(spec, default=partial(_parts, without), separators=(",", ":"))


def _parts(without: Collection[str], value: Any) -> Any:
    """One level of a value for a JSON text, so that only what is being written is in memory."""
    class_: Any = type(value)
    names = _attributes(class_)
    if names is not None:
        wanted = [name for name in names if name not in without] if without else names
        parts = map(partial(getattr, value), wanted)
        return {class_.__name__: [None if type(part) in (Source, Span) else part for part in parts]}
    if class_ is frozenset:
        return sorted(value)
    raise TypeError(f"a {class_.__name__} is no part of a specification")


@cache
def _attributes(class_: type) -> tuple[str, ...] | None:
    """The attributes of a class of specifications, in order; `None` for any other class."""
    names: tuple[str, ...] | None = getattr(class_, "__match_args__", None)
    return names if _classes().get(class_.__name__) is class_ else None
