"""Databases of coverage for tests."""

from itertools import product

from msgspec.structs import replace

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
