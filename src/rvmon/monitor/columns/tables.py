"""Arrays with an entry for each of the same things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, Self

import numpy as np


class Table:
    """A base of dataclasses whose fields are arrays of one length, tables, or `None`."""

    __slots__ = ()

    def pick(self, which: Any) -> Self:
        """Some of the entries, independent from now on unless `which` is a slice."""
        return type(self)(*[_picked(getattr(self, one.name), which) for one in fields(self)])  # type: ignore[arg-type]

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The entries of all parts, in their order; there is one."""
        if len(parts) == 1:
            return parts[0]
        columns = ([getattr(part, one.name) for part in parts] for one in fields(cls))  # type: ignore[arg-type]
        return cls(*map(_joined, columns))


def _picked(column: Any, which: Any) -> Any:
    if isinstance(column, Table):
        return column.pick(which)
    return None if column is None else column[which]


def _joined(columns: list[Any]) -> Any:
    first = columns[0]
    if isinstance(first, Table):
        return type(first).joined(columns)
    return None if first is None else np.concatenate(columns)
