"""Topics stored as columns, whose messages are rows, for logs that are read topic by topic."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from rvmon.recordings.messages import Message, Messages, Topic, errors_as_damage
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind

Columns = Mapping[str, Any]
"""Arrays by path of the field: [n] or [n, k] for a field of k values; masked: no value."""


class ColumnTopic(Struct, frozen=True):
    """A topic and its columns."""

    topic: Topic
    count: int  # of its rows
    # reads the stamps (int64[n] ticks, in any order) and the columns
    load: Callable[[], tuple[Any, Columns]]


class ColumnMessages(Messages):
    """An open recording of topics stored as columns; `close` closes the file."""

    def __init__(
        self,
        topics: Sequence[ColumnTopic],
        end: int | None,
        outages: Sequence[Outage] = (),
        close: Callable[[], object] = lambda: None,
    ) -> None:
        # Names that differ only in characters that `path_of` replaces became equal.
        names = distinct([topic.topic.name for topic in topics])
        self._topics = dict(zip(names, topics, strict=True))
        self.topics = {name: replace(one.topic, name=name) for name, one in self._topics.items()}
        self.count = sum(topic.count for topic in topics)
        self.end = end
        self.outages = outages
        self._close = close

    def close(self) -> None:
        """Close the file."""
        self._close()

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the rows of these topics by time; at one instant, in the order of the topics."""
        names = [name for name in self._topics if name in topics]
        loaded = [self._topics[name].load() for name in names]
        if not loaded:
            return
        times = np.concatenate([own for own, _ in loaded])
        sources = np.repeat(np.arange(len(loaded)), [len(own) for own, _ in loaded])
        places = np.concatenate([np.arange(len(own)) for own, _ in loaded])
        order = np.argsort(times, kind="stable")
        trees = [_tree(columns) for _, columns in loaded]
        for t, source, place in zip(
            times[order].tolist(), sources[order].tolist(), places[order].tolist(), strict=True
        ):
            yield names[source], t, _Row(trees[source], place)


class LateColumn:
    """A column that is read from the file on demand.

    `read` gives its values, and a list of flags for the invalid ones, or `None` if all are valid.
    """

    def __init__(
        self, form: str, read: Callable[[], tuple[Any, Any]], dtype: Any, ndim: int, unit: str = ""
    ) -> None:
        self._form, self._read = form, read
        self.dtype, self.ndim, self.unit = dtype, ndim, unit

    def tolist(self) -> list[Any]:
        """Read the values, with bytes as texts and `None` for invalid ones."""
        with errors_as_damage(self._form):
            values, invalid = self._read()
        cells: list[Any] = values.tolist()
        if values.dtype.kind in "SO":
            cells = [
                cell.decode("utf-8", "replace") if isinstance(cell, bytes) else cell
                for cell in cells
            ]
        if invalid is not None:
            cells = [None if wrong else one for one, wrong in zip(cells, invalid, strict=True)]
        return cells


class _Row(Mapping[str, Any]):
    """A row as the content of a message; a column is turned into a list at its first use."""

    __slots__ = ("_place", "_tree")

    def __init__(self, tree: dict[str, Any], place: int) -> None:
        self._tree = tree
        self._place = place

    def __getitem__(self, name: str) -> Any:
        inner = self._tree[name]
        if type(inner) is list:
            return inner[self._place]
        if type(inner) is dict:
            if all(isinstance(key, int) for key in inner):
                return [_Row(inner[key], self._place) for key in sorted(inner)]
            return _Row(inner, self._place)
        self._tree[name] = made = inner.tolist()
        return made[self._place]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tree)

    def __len__(self) -> int:
        return len(self._tree)


def _tree(columns: Columns) -> dict[str, Any]:
    """Nest columns by the steps of their paths: `esc[0].rpm` is in element 0 of `esc`."""
    tree: dict[str, Any] = {}
    for path, column in columns.items():
        found = re.findall(r"[^.\[\]]+", path)
        *above, last = [int(step) if step.isdigit() else step for step in found]
        inner: dict[Any, Any] = tree
        for step in above:
            inner = inner.setdefault(step, {})
        inner[last] = column
    return tree


def leaves_of(columns: Columns) -> dict[str, Kind]:
    """The fields of columns with their kinds; columns of several values per row are arrays."""
    kinds = {"b": Kind.BOOL, "i": Kind.INT, "u": Kind.INT, "f": Kind.REAL}
    return {
        _leaf(path, column): kinds.get(column.dtype.kind, Kind.LABEL)
        for path, column in columns.items()
    }


def units_of(columns: Mapping[str, LateColumn]) -> dict[str, str]:
    """The units of fields, for the columns that state one."""
    return {_leaf(path, column): column.unit for path, column in columns.items() if column.unit}


def _leaf(path: str, column: Any) -> str:
    return re.sub(r"\[\d+\]", "[]", path) + "[]" * int(column.ndim - 1)


def joined(columns: Mapping[str, Any]) -> dict[str, Any]:
    """Join the columns of the elements of an array, `q[0]` and `q[1]`, to one column."""
    found: dict[str, Any] = {}
    arrays: dict[str, list[Any]] = {}
    for path, column in columns.items():
        array, is_element, place = path.removesuffix("]").rpartition("[")
        if is_element and path.endswith("]") and place == str(len(arrays.get(array, ()))):
            arrays.setdefault(array, []).append(column)
        else:
            found[path] = column
    return found | {array: np.stack(parts, axis=1) for array, parts in arrays.items()}


def path_of(name: str) -> str:
    """The name of a channel, turned into the path of a field.

    >>> path_of("Engine.Speed [rpm]"), path_of("2nd gear")
    ('Engine_Speed_rpm', '_2nd_gear')
    """
    path = re.sub(r"\W+", "_", name).strip("_") or "_"
    return f"_{path}" if path[0].isdigit() else path


def distinct(names: Sequence[str]) -> list[str]:
    """Make names distinct: one that was there before gets a number.

    >>> distinct(["a", "b", "a"])
    ['a', 'b', 'a_2']
    """
    found: dict[str, None] = {}
    for name in names:
        number, made = 2, name
        while made in found:
            number, made = number + 1, f"{name}_{number}"
        found[made] = None
    return list(found)
