"""Databases of coverage: what is to be covered, the tests of campaigns, and what each hit.

>>> from rvmon.coverage import Hit
>>> from rvmon.coverage import Item, Subject, group_of, model_of
>>> gaze = group_of("gaze", Subject.COVERPOINT, [Item("yes"), Item("no", goal=3)])
>>> with Database.in_memory() as database:
...     database.declare(model_of([gaze]))
...     database.record(TestRecord("monday", when=0), {"gaze": {"yes": Hit(2, first=5)}})
...     [entry.record.name for entry in database.coverage().entries]
['monday']
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rvmon.coverage import Coverage, Hits, Model, TestRecord
from rvmon.coverage.schema import connect, damaged, name_of, readable_errors, transaction
from rvmon.coverage.stored_model import (
    Stored,
    model_from,
    read_groups,
    stored_of,
    write_groups,
)
from rvmon.coverage.stored_tests import entry_of, read_entries, write_entries
from rvmon.errors import CoverageError


class Database:
    """A database of coverage that is open: in one process and one thread, beside others.

    Each call writes all that it is given or nothing, whatever ends the process; a test that is
    there already is not written twice. Calls wait for other processes that write.

    Args:
        connection: to its tables.
        path: of its file; `None` if it is in memory.
    """

    def __init__(self, connection: sqlite3.Connection, path: str | Path | None) -> None:
        self._tables = connection
        self._path = path
        self._items = _Items({})

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Open a file to write to; it is made if it does not exist.

        Raises:
            CoverageError: it is no database of coverage, is damaged, of a newer version, or cannot
                be written.
        """
        return cls(connect(path, create=True), path)

    @classmethod
    def in_memory(cls) -> Self:
        """A database that is gone when it is closed."""
        return cls(connect(None, create=True), None)

    def declare(self, model: Model) -> None:
        """Say what is to be covered; what was declared before stays.

        Args:
            model: may be declared any number of times, and may have more than before.

        Raises:
            CoverageError: a group or an item is known with another goal, kind, weight, subject or
                axes; it is named, and nothing is written.
        """
        with transaction(self._tables, self._path):
            write_groups(self._tables, self._path, self._stored(), stored_of(model))

    def record(self, test: TestRecord, hits: Hits) -> None:
        """Add a test and what it hit.

        Args:
            test: what became of it.
            hits: by group and item of a model that was declared.

        Raises:
            CoverageError: an item is in no model, or the file cannot be written.
        """
        items = self._with((group, item) for group, items in hits.items() for item in items)
        with readable_errors(self._path):
            entry = entry_of(test, hits, items.places)
        with transaction(self._tables, self._path):
            write_entries(self._tables, [entry], items.ids)

    def explain(self, group: str, item: str, reason: str) -> None:
        """Add why an item is not covered; holes are shown with it.

        Raises:
            CoverageError: there is no such item, or the file cannot be written.
        """
        with transaction(self._tables, self._path):
            self._explain(self._with([(group, item)]), {(group, item): [reason]})

    def exclude(self, group: str, item: str, reason: str) -> None:
        """Say that an item cannot be hit, and why: it is no goal any more, and a hit is an error.

        Raises:
            CoverageError: there is no such item, or the file cannot be written.
        """
        with transaction(self._tables, self._path):
            self._explain(self._with([(group, item)]), {(group, item): [reason]}, "unreachable")

    def merge(self, other: Database) -> None:
        """Add all that another database holds.

        In whatever order and how often databases are merged, the same comes out.

        Raises:
            CoverageError: the models contradict each other (the item is named), the other one is
                damaged, or this one cannot be written; nothing is written then.
        """
        groups, coverage = other._snapshot()
        with transaction(self._tables, self._path):
            source = other._path or self._path
            write_groups(self._tables, source, self._stored(), groups)
            own = _Items(self._stored())
            ids = np.array([own.ids[own.places[item]] for item in coverage.items], np.int64)
            write_entries(self._tables, coverage.entries, ids)
            self._explain(own, coverage.reasons)
            self._explain(own, coverage.unreachable, "unreachable")

    def coverage(self) -> Coverage:
        """All that it holds.

        Raises:
            CoverageError: it is damaged.
        """
        return self._snapshot()[1]

    def _snapshot(self) -> tuple[Stored, Coverage]:
        """All that it holds at one instant, whoever writes meanwhile; the groups as stored, too."""
        with transaction(self._tables, self._path, writes=False):
            stored = self._stored()
            items = _Items(stored)
            names = list(items.places)
            named = dict(zip(items.ids.tolist(), names, strict=True))
            reasons = self._reasons(named, "reasons")
            unreachable = self._reasons(named, "unreachable")
            entries = read_entries(self._tables, self._path, items.ids)
        return stored, Coverage(model_from(stored), names, entries, reasons, unreachable)

    def _reasons(
        self, named: Mapping[int, tuple[str, str]], table: str
    ) -> dict[tuple[str, str], list[str]]:
        found: dict[tuple[str, str], list[str]] = {}
        words = f"SELECT item, reason FROM {table} ORDER BY item, reason"  # noqa: S608 - our words
        for item, reason in self._tables.execute(words):
            if item not in named:
                raise damaged(self._path, "a reason stands at no item")
            found.setdefault(named[item], []).append(str(reason))
        return found

    def _stored(self) -> Stored:
        with readable_errors(self._path):
            return read_groups(self._tables, self._path)

    def _with(self, named: Iterable[tuple[str, str]]) -> _Items:
        """The items as they were last read, or now if they lack one of those that are named."""
        if any(one not in self._items.places for one in named):
            self._items = _Items(self._stored())  # declared since, perhaps by another process
        return self._items

    def _explain(
        self,
        items: _Items,
        reasons: Mapping[tuple[str, str], Iterable[str]],
        table: str = "reasons",
    ) -> None:
        for (group, item), texts in reasons.items():
            if (group, item) not in items.places:
                raise CoverageError(
                    f"error: {name_of(self._path)}: there is no item `{item}` of `{group}`: "
                    "declare its model first"
                )
            number = int(items.ids[items.places[group, item]])
            self._tables.executemany(
                f"INSERT OR IGNORE INTO {table} (item, reason) VALUES (?, ?)",  # noqa: S608 - one of ours
                ((number, reason) for reason in texts),
            )

    def close(self) -> None:
        """Close the file; what was written is there already."""
        with readable_errors(self._path):
            self._tables.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()


def read(paths: Sequence[str | Path]) -> Coverage:
    """All that some files hold together.

    Args:
        paths: at least one; they are not changed.

    Raises:
        CoverageError: one is no database of coverage, is damaged, of a newer version, or has a
            model that contradicts another's.
    """
    if len(paths) == 1:
        with Database(connect(paths[0], create=False), paths[0]) as database:
            return database.coverage()
    with _together(paths) as database:
        return database.coverage()


def merge(paths: Iterable[str | Path], out: str | Path) -> None:
    """Write all that some files hold into one; what that one holds already stays.

    Raises:
        CoverageError: as `read`, or the file cannot be written; nothing is written then.
    """
    with _together(paths) as database, Database.open(out) as target:
        target.merge(database)


def _together(paths: Iterable[str | Path]) -> Database:
    """A database in memory with all that some files hold."""
    together = Database.in_memory()
    try:
        for path in paths:
            with Database(connect(path, create=False), path) as database:
                together.merge(database)
    except BaseException:
        together.close()
        raise
    return together


class _Items:
    """The items of a database in the order of its model.

    Attributes:
        places: in that order, by names of group and item.
        ids: in the tables, by place.
    """

    def __init__(self, stored: Stored) -> None:
        named = [
            (group.name, item)
            for group in model_from(stored).groups.values()
            for item in group.items
        ]
        self.places = {names: place for place, names in enumerate(named)}
        self.ids: NDArray[np.int64] = np.array(
            [stored[group].items[item].id for group, item in named], np.int64
        )
