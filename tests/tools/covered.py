"""Databases of coverage for tests."""

from __future__ import annotations

import random
from collections.abc import Iterable
from dataclasses import replace
from itertools import product

from rvmon.coverage import (
    Ending,
    Group,
    Hit,
    Hits,
    Item,
    Model,
    Subject,
    TestRecord,
    combination,
    group_of,
    model_of,
)
from rvmon.coverage.database import Database
from rvmon.language.checked.properties import BinKind
from rvmon.verdicts import Verdict

SECOND = 1_000_000_000


def door_model() -> Model:
    """Two coverpoints, their cross with an illegal and an ignored item, and a requirement."""
    gaze, near = ["yes", "no"], ["touch", "reach", "far"]
    kinds = {("no", "touch"): BinKind.ILLEGAL, ("yes", "far"): BinKind.IGNORE}
    crossed = {
        combination(pair): Item(combination(pair), kinds.get(pair, BinKind.GOAL))
        for pair in product(gaze, near)
    }
    return model_of(
        [
            group_of("gaze", Subject.COVERPOINT, [Item("yes"), Item("no", goal=3)]),
            group_of("near", Subject.COVERPOINT, [Item(name) for name in near]),
            Group("situation", Subject.CROSS, crossed, weight=2, axes={"gaze": gaze, "near": near}),
            group_of("D1", Subject.REQUIREMENT, [Item("triggered"), Item("passed")], weight=0),
        ]
    )


def hits_of(*names: tuple[str, str], count: int = 1, first: int | None = None) -> Hits:
    """One hit of each of some items."""
    hits: dict[str, dict[str, Hit]] = {}
    for group, item in names:
        hits.setdefault(group, {})[item] = Hit(count, first)
    return hits


def fill(database: Database) -> None:
    """Record a small campaign of which everything can be said that there is to say."""
    database.declare(door_model())
    passed, failed = {"D1": Verdict.PASS}, {"D1": Verdict.FAIL}
    look, touch = ("gaze", "yes"), ("near", "touch")
    tests = [
        (
            TestRecord("calm-1", "week 1", "random", seed=1, system="door", verdicts=passed),
            hits_of(look, ("D1", "triggered"), count=2, first=SECOND),
        ),
        (
            TestRecord("calm-2", "week 1", "random", seed=2, system="door", verdicts=passed),
            hits_of(look, touch, ("situation", "yes × touch")),
        ),
        (
            TestRecord("wild-1", "week 1", "directed", seed=3, system="door", verdicts=failed),
            hits_of(("situation", "no × touch"), ("gaze", "no"), touch, first=7 * SECOND),
        ),
        (
            TestRecord(
                "wild-2",
                "week 1",
                "directed",
                recording="runs/wild-2.csv",
                ending=Ending.CRASHED,
                error="ZeroDivisionError: the gap is 0",
            ),
            hits_of(("gaze", "no"), count=2),
        ),
    ]
    for number, (test, hits) in enumerate(tests):
        placed = replace(test, number=number, when=number * SECOND, seconds=0.5)
        database.record(placed, hits)
    database.explain("near", "far", "the arm is 1 m long: `far` begins at 1 m")


def random_database(seed: int) -> Database:
    """A database in memory that has parts of a model and of a set of tests.

    What two of them both have is the same in both, but for the places of groups, items and tests.
    """
    rng = random.Random(seed)
    database = Database.in_memory()
    groups = []
    for name in rng.sample("abc", rng.randint(1, 3)):
        items = rng.sample("uvwxyz", rng.randint(1, 4))
        axes = {"axis": items} if name == "c" else {}
        subject = Subject.CROSS if name == "c" else Subject.COVERPOINT
        named = {item: Item(item, goal=1 + "uvwxyz".index(item) % 3) for item in items}
        groups.append(Group(name, subject, named, 1, axes))
    database.declare(model_of(groups))
    every = [(group.name, item) for group in groups for item in group.items]
    for _ in range(rng.randint(0, 3)):
        hit = rng.sample(every, rng.randint(0, min(2, len(every))))
        test = TestRecord(
            rng.choice(["t1", "t2"]),
            rng.choice(["k", "l"]),
            number=rng.randint(0, 1),
            seconds=rng.choice([0.0, 1.0]),
            when=rng.randint(0, 2),
        )
        database.record(test, hits_of(*hit))
    for group, item in rng.sample(every, rng.randint(0, 1)):
        database.explain(group, item, rng.choice(["far", "never"]))
    return database


def merged(databases: Iterable[Database]) -> Database:
    """A database in memory with all that others hold."""
    together = Database.in_memory()
    for database in databases:
        together.merge(database)
    return together


def dump(database: Database) -> object:
    """All that a database holds, as data that can be compared."""
    coverage = database.coverage()
    groups = [
        (group.name, group.subject, group.weight, [*group.items.values()], [*group.axes.items()])
        for group in coverage.model.groups.values()
    ]
    entries = [
        (
            entry.digest,
            entry.record,
            [coverage.items[place] for place in entry.row.items],
            entry.row.counts.tolist(),
            entry.row.firsts.tolist(),
        )
        for entry in coverage.entries
    ]
    return groups, entries, coverage.reasons
