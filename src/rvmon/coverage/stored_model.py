"""Write and read the model of a coverage database: its groups and items."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from pathlib import Path

import msgspec
from msgspec import Struct

from rvmon.coverage import Group, Item, Model, Subject
from rvmon.coverage.database_file import damaged, name_of
from rvmon.errors import CoverageError
from rvmon.language.checked.properties import BinKind


class StoredItem(Struct, frozen=True):
    """An item with its position in its group, and its id in the table (0: none yet)."""

    kind: BinKind
    goal: int
    position: int
    text: str
    id: int = 0


class StoredGroup(Struct, frozen=True):
    """A group with its position in its model.

    Positions make merging commutative: each part of the merged model gets the least of its
    positions, regardless of the order in which models are merged.
    """

    subject: Subject
    weight: int
    position: int
    axes: Mapping[str, Mapping[str, int]]
    title: str
    items: Mapping[str, StoredItem]


Stored = Mapping[str, StoredGroup]  # the groups by name, unordered


def stored_of(model: Model) -> Stored:
    """A model with positions, as it is written."""
    return {
        group.name: StoredGroup(
            group.subject,
            group.weight,
            position,
            {axis: {name: n for n, name in enumerate(bins)} for axis, bins in group.axes.items()},
            group.title,
            {
                item.name: StoredItem(item.kind, item.goal, place, item.text)
                for place, item in enumerate(group.items.values())
            },
        )
        for position, group in enumerate(model.groups.values())
    }


def model_from(stored: Stored) -> Model:
    """The model of stored groups, ordered by position, then name."""
    groups = {}
    for name in sorted(stored, key=lambda name: (stored[name].position, name)):
        group = stored[name]
        ordered = sorted(group.items.items(), key=lambda named: (named[1].position, named[0]))
        items = {item: Item(item, one.kind, one.goal, one.text) for item, one in ordered}
        axes = {
            axis: sorted(bins, key=lambda name: (bins[name], name))
            for axis, bins in group.axes.items()
        }
        groups[name] = Group(name, group.subject, items, group.weight, axes, group.title)
    return Model(groups)


def read_groups(database: sqlite3.Connection, path: str | Path | None) -> Stored:
    """Read the groups and items.

    Raises:
        CoverageError: the contents are damaged.
    """
    items: dict[int, dict[str, StoredItem]] = {}
    try:
        for number, owner, name, kind, goal, position, text in database.execute(
            "SELECT id, owner, name, kind, goal, position, text FROM items"
        ):
            one = StoredItem(BinKind(kind), int(goal), int(position), str(text), int(number))
            items.setdefault(owner, {})[str(name)] = one
        stored = {
            str(name): StoredGroup(
                Subject(subject),
                int(weight),
                int(position),
                dict(msgspec.json.decode(axes, type=list[tuple[str, dict[str, int]]])),
                str(title),
                items.get(number, {}),
            )
            for number, name, subject, weight, axes, position, title in database.execute(
                "SELECT id, name, subject, weight, axes, position, title FROM groups"
            )
        }
        for name, group in stored.items():
            _refuse_nonsense(name, group)
        return stored
    except (ValueError, TypeError, msgspec.MsgspecError) as error:
        raise damaged(path, f"groups and items: {error}") from None


def write_groups(
    database: sqlite3.Connection, path: str | Path | None, known: Stored, more: Stored
) -> None:
    """Add groups and items, `more`, to the known ones; call it within a transaction.

    `path` is the file that they come from, for errors.

    Raises:
        CoverageError: a group or item contradicts a known one, or a number is invalid; nothing is
            written.
    """
    for name, group in more.items():
        try:
            _refuse_nonsense(name, group)
        except ValueError as error:
            raise CoverageError(f"error: {name_of(path)}: {error}") from None
        if (own := known.get(name)) is not None:
            _refuse_conflict(path, name, own, group)
    for name, group in more.items():
        own = known.get(name)
        axes = _united(own.axes, group.axes) if own is not None else group.axes
        encoded = msgspec.json.encode(list(axes.items()), order="deterministic").decode()
        (number,) = database.execute(
            "INSERT INTO groups (name, subject, weight, axes, position, title) "
            "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (name) DO UPDATE SET axes = excluded.axes, "
            "position = min(position, excluded.position), title = max(title, excluded.title) "
            "RETURNING id",
            (name, group.subject, group.weight, encoded, group.position, group.title),
        ).fetchone()
        database.executemany(
            "INSERT INTO items (owner, name, kind, goal, position, text) "
            "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (owner, name) DO UPDATE SET "
            "position = min(position, excluded.position), text = max(text, excluded.text)",
            (
                (number, item, one.kind, one.goal, one.position, one.text)
                for item, one in group.items.items()
            ),
        )


def _refuse_nonsense(name: str, group: StoredGroup) -> None:
    """Raise `ValueError` if a weight or goal is invalid."""
    if group.weight < 0:
        raise ValueError(f"group `{name}` has weight {group.weight}: give at least 0")
    for item, stored_item in group.items.items():
        if stored_item.goal < 1:
            raise ValueError(
                f"item `{item}` of `{name}` has goal {stored_item.goal}: give at least 1"
            )


def _refuse_conflict(
    path: str | Path | None, name: str, own: StoredGroup, other: StoredGroup
) -> None:
    fix = "keep the two in separate databases, or give the changed one another name"
    for what, before, after in (
        ("is about", own.subject.value, other.subject.value),
        ("has weight", own.weight, other.weight),
        ("has the axes", *(", ".join(one.axes) or "none" for one in (own, other))),
    ):
        if before != after:
            raise CoverageError(
                f"error: {name_of(path)}: group `{name}` {what} {after} here, {before} in "
                f"what it is added to: {fix}"
            )
    for item, stored_item in other.items.items():
        known = own.items.get(item)
        if known is not None and (known.kind, known.goal) != (stored_item.kind, stored_item.goal):
            raise CoverageError(
                f"error: {name_of(path)}: item `{item}` of group `{name}` is "
                f"{_meaning(stored_item)} here, {_meaning(known)} in what it is added to: {fix}"
            )


def _meaning(item: StoredItem) -> str:
    hits = "1 hit" if item.goal == 1 else f"{item.goal} hits"
    return f"a goal of {hits}" if item.kind is BinKind.GOAL else item.kind.value


def _united(
    one: Mapping[str, Mapping[str, int]], other: Mapping[str, Mapping[str, int]]
) -> Mapping[str, Mapping[str, int]]:
    """The union of the bins of equal axes, each bin at its least position."""
    return {
        axis: {
            name: min(places[name] for places in (bins, other[axis]) if name in places)
            for name in {**bins, **other[axis]}
        }
        for axis, bins in one.items()
    }
