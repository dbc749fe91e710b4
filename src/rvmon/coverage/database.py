"""Coverage databases: a model, the tests of campaigns, and the hits of each test.

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
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rvmon.coverage import Coverage, Hits, Model, TestRecord
from rvmon.coverage.database_file import connect, damaged, name_of, readable_errors, transaction
from rvmon.coverage.stored_model import Stored, model_from, read_groups, stored_of, write_groups
from rvmon.coverage.stored_tests import entry_of, read_entries, write_entries
from rvmon.errors import CoverageError


class Database:
    """An open coverage database, used by one thread; other processes may use the same file.

    Each call is atomic, even if the process is killed; a test that is already stored is not added
    again. Calls wait for other processes that write.

    Args:
        connection: from `connect`.
        path: of its file; `None` if it is in memory.
    """

    def __init__(self, connection: sqlite3.Connection, path: str | Path | None) -> None:
        self._tables = connection
        self._path = path
        self._items = _Items({})

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Open a file for writing; it is created if it does not exist.

        Raises:
            CoverageError: the file is not a coverage database, is damaged, has another version, or
                cannot be written.
        """
        return cls(connect(path, create=True), path)

    @classmethod
    def in_memory(cls) -> Self:
        """A new database in memory."""
        return cls(connect(None, create=True), None)

    def declare(self, model: Model) -> None:
        """Add a model; earlier declarations stay.

        Args:
            model: may be declared repeatedly, and may extend earlier ones.

        Raises:
            CoverageError: a group or item is known with another goal, kind, weight, subject or
                axes; the message names it, and nothing is written.
        """
        with transaction(self._tables, self._path):
            write_groups(self._tables, self._path, self._stored(), stored_of(model))

    def record(self, test: TestRecord, hits: Hits) -> None:
        """Add a test and its hits.

        Args:
            test: the test with its result.
            hits: by group and item of a declared model.

        Raises:
            CoverageError: an item is not declared, or the file cannot be written.
        """
        items = self._with((group, item) for group, items in hits.items() for item in items)
        with readable_errors(self._path):
            entry = entry_of(test, hits, items.places)
        with transaction(self._tables, self._path):
            write_entries(self._tables, [entry], items.ids)

    def explain(self, group: str, item: str, reason: str) -> None:
        """Add a reason why an item is not covered, which is shown with the hole.

        Raises:
            CoverageError: there is no such item, or the file cannot be written.
        """
        with transaction(self._tables, self._path):
            self._explain(self._with([(group, item)]), {(group, item): [reason]})

    def exclude(self, group: str, item: str, reason: str) -> None:
        """Declare an item unreachable, with a reason, so that it is not a goal.

        Raises:
            CoverageError: there is no such item, or the file cannot be written.
        """
        with transaction(self._tables, self._path):
            self._explain(self._with([(group, item)]), {(group, item): [reason]}, "unreachable")

    def merge(self, other: Database) -> None:
        """Add the contents of another database; commutative, associative and idempotent.

        Raises:
            CoverageError: the models contradict each other (the message names the item), the other
                database is damaged, or this one cannot be written; nothing is written then.
        """
        groups, coverage = other._snapshot()
        with transaction(self._tables, self._path):
            # A contradiction is reported with the file that caused it.
            source = other._path or self._path
            write_groups(self._tables, source, self._stored(), groups)
            stored = _Items(self._stored())
            ids = np.array([stored.ids[stored.places[item]] for item in coverage.items], np.int64)
            write_entries(self._tables, coverage.entries, ids)
            self._explain(stored, coverage.reasons)
            self._explain(stored, coverage.unreachable, "unreachable")

    def coverage(self) -> Coverage:
        """The contents.

        Raises:
            CoverageError: it is damaged.
        """
        return self._snapshot()[1]

    def _snapshot(self) -> tuple[Stored, Coverage]:
        """The contents in one consistent state, also the groups as stored."""
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
        reasons: dict[tuple[str, str], list[str]] = {}
        words = f"SELECT item, reason FROM {table} ORDER BY item, reason"  # noqa: S608 - our words
        for item, reason in self._tables.execute(words):
            if item not in named:
                raise damaged(self._path, "a reason refers to no item")
            reasons.setdefault(named[item], []).append(str(reason))
        return reasons

    def _stored(self) -> Stored:
        with readable_errors(self._path):
            return read_groups(self._tables, self._path)

    def _with(self, named: Iterable[tuple[str, str]]) -> _Items:
        """The cached items, read again if they lack one of `named`."""
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
        """Close the file; all writes are already committed."""
        with readable_errors(self._path):
            self._tables.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def read(paths: Sequence[str | Path]) -> Coverage:
    """The merged contents of some files.

    Args:
        paths: at least one; the files are not changed.

    Raises:
        CoverageError: a file is not a coverage database, is damaged, has another version, or its
            model contradicts another one.
    """
    if len(paths) == 1:
        with Database(connect(paths[0], create=False), paths[0]) as database:
            return database.coverage()
    with _together(paths) as database:
        return database.coverage()


def merge(paths: Iterable[str | Path], out: str | Path) -> None:
    """Merge some files into another one, which keeps its own contents.

    Raises:
        CoverageError: as `read`, or the file cannot be written; nothing is written then.
    """
    with _together(paths) as database, Database.open(out) as target:
        target.merge(database)


def _together(paths: Iterable[str | Path]) -> Database:
    """A database in memory with the merged contents of some files."""
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
    """The items of a database in the order of its model."""

    def __init__(self, stored: Stored) -> None:
        named = [
            (group.name, item)
            for group in model_from(stored).groups.values()
            for item in group.items
        ]
        # The index of each item in that order, by names of group and item.
        self.places = {names: place for place, names in enumerate(named)}
        # The ids in the table, by index.
        self.ids: NDArray[np.int64] = np.array(
            [stored[group].items[item].id for group, item in named], np.int64
        )
