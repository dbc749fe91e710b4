"""Coverage databases for tests of merging."""

import random
from collections.abc import Iterable

from tests.tools.covered import hits_of

from rvmon.coverage import Group, Item, Subject, TestRecord, model_of
from rvmon.coverage.database import Database


def random_database(seed: int) -> Database:
    """A database in memory with parts of a model and of a set of tests.

    Shared parts of two databases are equal but for the order of groups, items and tests.
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
    """A database in memory, merged from others."""
    together = Database.in_memory()
    for database in databases:
        together.merge(database)
    return together
