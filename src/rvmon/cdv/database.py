"""What a campaign adds to a database of coverage: its model, and a record of each test."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.measured import PAIRS, STATES, TRANSITIONS, measured_groups
from rvmon.cdv.outcome import Outcome, Results
from rvmon.cdv.watch import watches_of
from rvmon.coverage.database import Database
from rvmon.coverage.model import Group, Item, Model, group_of, model_of
from rvmon.coverage.record import TestRecord
from rvmon.errors import CoverageError
from rvmon.session import Spec
from rvmon.spec.checked.goals import BinKind


def declare(path: Path, campaign: Campaign, specs: Mapping[str, Spec]) -> None:
    """Say in a database what the campaign is to cover: before it is played.

    Args:
        path: of the database; it is made if there is none.
        campaign: what it is about.
        specs: by robot, what judges it.

    Raises:
        CoverageError: it is no database, cannot be written, or says otherwise of the same items; or
            two coverage models of a robot have groups of one name.
    """
    with Database.open(path) as database:
        for model in _models(campaign, specs):
            database.declare(model)


def record(path: Path, results: Results) -> None:
    """Add the tests on the robots as they are; planted faults say nothing about those.

    Args:
        path: of the database, in which the campaign was declared.
        results: what was played.

    Raises:
        CoverageError: it cannot be written.
    """
    campaign, seed = results.plan.campaign, results.plan.seed
    with Database.in_memory() as database:  # written at once: a test by itself waits for the disk
        with Database.open(path) as known:
            database.declare(known.coverage().model)
        outcomes = [one.outcome for one in results.played]
        database.declare(model_of([*_seen(campaign, outcomes)]))
        for number, one in enumerate(results.played):
            test, outcome = one.job.test, one.outcome
            if test.mutation is None:
                entry = TestRecord(
                    test.name,
                    campaign=f"{campaign.name}, seed {seed}",
                    strategy=test.strategy,
                    seed=test.seed,
                    system=one.job.robot,
                    verdicts=outcome.verdicts,
                    ending=outcome.ending,
                    error=outcome.error or "",
                    number=number,
                    seconds=outcome.seconds,
                )
                database.record(entry, outcome.hits)
        with Database.open(path) as target:
            target.merge(database)


def _models(campaign: Campaign, specs: Mapping[str, Spec]) -> Iterable[Model]:
    measured = measured_groups(campaign)
    for name, robot in campaign.robots.items():
        watched = watches_of(robot, specs[name], everything=True) if name in specs else []
        groups = [group for watch in watched for group in watch.model.groups.values()]
        try:
            yield model_of([*groups, *measured])
        except ValueError as error:
            raise CoverageError(f"robot `{name}`: its coverage models have {error}") from None


def _seen(campaign: Campaign, outcomes: Iterable[Outcome]) -> Iterable[Group]:
    """States and transitions that nobody declared: they count for nothing."""
    several = list(outcomes)
    declared = {group.name: group for group in measured_groups(campaign)}
    for name in (STATES, TRANSITIONS, PAIRS):
        seen = {item for one in several for item in one.hits.get(name, ())}
        more = sorted(seen - declared[name].items.keys())
        yield group_of(name, declared[name].subject, [Item(item, BinKind.IGNORE) for item in more])
