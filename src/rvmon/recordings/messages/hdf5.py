"""Reader of arrays in HDF5 and MATLAB files; needs h5py, or scipy for older MATLAB files.

Both are in the extra `h5`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Topic, column_topics, errors_as_damage
from rvmon.recordings.table_recording import ticks_of_column
from rvmon.texts import did_you_mean
from rvmon.trace.schema import Stamps
from rvmon.trace.stamps import stamps_of, ticks_of_stamp
from rvmon.trace.time import TICKS_PER_UNIT

_FORM = "a file of arrays"
_MAGIC = b"\x89HDF\r\n\x1a\n"

_TIMES = ("t", "time", "timestamp", "timestamps", "t_ns", "time_ns", "timestamp_ns", "tout")
"""The usual names of arrays of stamps."""

_UNITS = {"seconds": "s", "sec": "s", "milliseconds": "ms", "microseconds": "us", "µs": "us"}


class _Array(column_topics.LateColumn):
    """An array whose first axis is time."""

    def __init__(
        self, read: Callable[[], Any], shape: tuple[int, ...], dtype: Any, unit: str = ""
    ) -> None:
        # An array of a single row or column is one-dimensional here.
        is_list = len(shape) == 2 and 1 in shape
        self.shape = (max(shape),) if is_list else shape
        super().__init__(
            _FORM,
            lambda: (read().reshape(-1) if is_list else read(), None),
            dtype,
            len(self.shape),
            unit,
        )


_Tree = dict[str, Any]  # arrays, and trees of them, by name


def array_messages(path: Path, stamps: Stamps | None) -> column_topics.ColumnMessages:
    """Open a file, in which each group or structure with an array of stamps is a topic.

    Args:
        path: the file.
        stamps: the array of stamps, as `group/name`; `None`: the array with a usual name in each
            group.

    Raises:
        TraceError: the file cannot be read, or has no array of stamps.
        RvmonError: a package is not installed.
        OSError: the file cannot be opened.
    """
    with open(path, "rb") as file:
        head = file.read(520)
    if head.startswith(_MAGIC) or head[512:].startswith(_MAGIC):
        tree, close = _hierarchy(path)
    elif path.suffix.lower() == ".mat" and head:
        tree, close = _matrices(path), lambda: None
    else:
        raise TraceError("is not an HDF5 file: it does not start like one")
    topics = list(_topics(tree, "", stamps))
    if not topics:
        close()
        names = [name for name, _ in _listed(tree, "")]
        if stamps is not None:
            meant = did_you_mean(stamps.column, names, f"there are {', '.join(names[:8])}")
            raise TraceError(f"no array of stamps `{stamps.column}`: {meant}")
        raise TraceError(
            f"no array has a usual name of stamps ({', '.join(_TIMES[:4])}, …): name it with "
            f"--time ARRAY[:UNIT]; there are {', '.join(names[:8]) or 'none'}"
        )
    with errors_as_damage(_FORM):
        end = max((int(topic.load()[0].max()) for topic in topics if topic.count), default=None)
    return column_topics.ColumnMessages(topics, end, close=close)


def _hierarchy(path: Path) -> tuple[_Tree, Callable[[], object]]:
    """The groups of an HDF5 file, and the function that closes it; MATLAB's axes are reversed."""
    with needed("HDF5", "h5py"):
        import h5py
    with errors_as_damage(_FORM):
        file = h5py.File(path, "r")

    def read(dataset: Any, turned: bool) -> Any:
        return dataset[()].T if turned else dataset[()]

    def tree_of(group: Any, above: frozenset[Any] = frozenset()) -> _Tree:
        found: _Tree = {}
        above |= {group}
        for name, inner in group.items():
            if isinstance(inner, h5py.Group):
                if not name.startswith("#") and inner not in above:  # a link may lead back
                    found[name] = tree_of(inner, above)
            elif isinstance(inner, h5py.Dataset) and inner.shape and not inner.dtype.names:
                turned = "MATLAB_class" in inner.attrs
                shape = inner.shape[::-1] if turned else inner.shape
                unit = inner.attrs.get("units", inner.attrs.get("unit", ""))
                unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
                found[name] = _Array(partial(read, inner, turned), shape, inner.dtype, unit)
        return found

    with errors_as_damage(_FORM):
        return tree_of(file), file.close


def _matrices(path: Path) -> _Tree:
    """The variables of a MATLAB file of a version before 7.3, which is not an HDF5 file."""
    with needed("a file of MATLAB", "scipy"):
        from scipy.io import loadmat
    with errors_as_damage(_FORM):
        content = loadmat(path, simplify_cells=True)

    def tree_of(variables: Mapping[str, Any]) -> _Tree:
        found: _Tree = {}
        for name, value in variables.items():
            if name.startswith("__"):
                continue
            if isinstance(value, dict):
                found[name] = tree_of(value)
            elif isinstance(value, list) and all(isinstance(one, dict) for one in value):
                found[name] = {
                    str(one.get("label") or f"{name}_{place}"): tree_of(one)
                    for place, one in enumerate(value)
                }
            elif isinstance(value, np.ndarray) and value.ndim and value.dtype.kind in "biufOU":
                found[name] = _Array(partial(np.asarray, value), value.shape, value.dtype)
        return found

    return tree_of(content)


def _listed(tree: _Tree, prefix: str) -> Iterator[tuple[str, _Array]]:
    for name, inner in tree.items():
        if isinstance(inner, dict):
            yield from _listed(inner, f"{prefix}{name}/")
        else:
            yield f"{prefix}{name}", inner


def _topics(tree: _Tree, place: str, stamps: Stamps | None) -> Iterator[column_topics.ColumnTopic]:
    """Yield a topic for each group with stamps; inner groups without stamps belong to it."""
    own = {name: array for name, array in tree.items() if isinstance(array, _Array)}
    for name, array in own.items():
        is_named = stamps is not None and stamps.column.strip("/") == f"{place}{name}"
        if len(array.shape) == 1 and (is_named or (stamps is None and name.lower() in _TIMES)):
            yield _topic(tree, place, name, stamps)
            break
    for name, inner in tree.items():
        if isinstance(inner, dict):
            yield from _topics(inner, f"{place}{name}/", stamps)


def _topic(tree: _Tree, place: str, time: str, stamps: Stamps | None) -> column_topics.ColumnTopic:
    array = tree[time]
    [count] = array.shape
    if stamps is None:
        unit = _UNITS.get(array.unit.partition(" since ")[0], array.unit)
        stamps = stamps_of(f"{time}:{unit}" if unit in TICKS_PER_UNIT else time)
    found = {
        name: one
        for name, one in _within(tree)
        if one is not array and one.shape[0] == count and one.ndim <= 2
    }
    paths = column_topics.distinct([column_topics.path_of(name) for name in found])
    columns = dict(zip(paths, found.values(), strict=True))
    leaves, units = column_topics.leaves_of(columns), column_topics.units_of(columns)
    name = "/" + "/".join(
        column_topics.path_of(step) for step in place.strip("/").split("/") if step
    )
    topic = Topic(name if place else "/data", "arrays", leaves, units=units)
    return column_topics.ColumnTopic(topic, count, lambda: (_ticks(array, stamps), columns))


def _within(tree: _Tree) -> Iterator[tuple[str, _Array]]:
    """Yield the arrays of a group, and of inner groups without stamps of their own."""
    for name, inner in tree.items():
        if isinstance(inner, _Array):
            yield name, inner
        elif not any(one.lower() in _TIMES for one in inner):
            # In Simulink's structures the array of every signal is called `values`.
            yield from (
                (name if one == "values" else f"{name}_{one}", array)
                for one, array in _within(inner)
            )


def _ticks(array: _Array, stamps: Stamps) -> Any:
    values = np.asarray(array.tolist())
    if stamps.unit == "s" and values.dtype.kind == "f":
        return ticks_of_column(values, stamps)
    return np.array([ticks_of_stamp(one, stamps) for one in values.tolist()], np.int64)
