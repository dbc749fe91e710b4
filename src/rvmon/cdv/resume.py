"""The journal of an unfinished campaign, from which a restarted campaign continues.

It stays in the campaign's folder until tables and pages are written. It is refused if anything that
outcomes depend on has changed since: tests, requirements or programs.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import msgspec
from msgspec import Struct, field

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_plan import Job, Outcome, Plan, Played
from rvmon.errors import RvmonError
from rvmon.execute import Shard, finished_shards, journal
from rvmon.files import contents
from rvmon.language.checked.serialise import to_plain
from rvmon.session import Spec

NAME = "unfinished.journal"
"""The name of the file in a campaign's folder."""

_PACKAGES = ("coverage", "msgspec", "numpy")
"""Packages that can affect the outcomes of any campaign."""


class _Entry(Struct, frozen=True):
    """A played test, and the wall time that the campaign had taken by then."""

    test: str
    robot: str
    outcome: Outcome
    control: Outcome | None
    seconds: float


class _Heading(Struct, frozen=True):
    """The first entry: which campaign this is."""

    inputs: str  # checksum of everything that outcomes depend on
    command: str  # the command line of the campaign


class Unfinished(journal.Journal, frozen=True):
    """A campaign that can be continued."""

    jobs: Sequence[Job] = ()  # in the order of the plan
    # Jobs that were played before, by test and robot.
    known: Mapping[tuple[str, str], Played] = field(default_factory=dict)
    seconds: float = 0.0  # wall time that these took
    shard: Shard | None = None  # the part of the campaign; `None`: all

    def played(self, one: Played, seconds: float) -> None:
        """Store a played test, and the wall time that the campaign has taken so far."""
        job = one.job
        self.keep(_Entry(job.test.name, job.robot, one.outcome, one.control, seconds))


def unfinished(
    folder: Path, plan: Plan, specs: Mapping[str, Spec], command: str, shard: Shard | None = None
) -> Unfinished:
    """Open the journal of a campaign in its folder, or start one.

    Without a `shard`, it is for all tests and uses the journals of finished shards.

    Raises:
        RvmonError: the journal there belongs to another campaign, or cannot be read or written.
    """
    path = folder / NAME if shard is None else shard.name(folder / NAME)
    shards = finished_shards(path) if shard is None else []
    heading = _Heading(_inputs(plan, specs), command)
    jobs = {(job.test.name, job.robot): job for job in plan.jobs()}
    places = {key: place for place, key in enumerate(jobs)}
    known: dict[tuple[str, str], Played] = {}
    seconds = 0.0
    try:
        # `path` comes last, so that `entries` and `ordered` are its own after the loop.
        for one in (*shards, path):
            left = journal.entries(one)
            entries = [msgspec.json.encode(heading)] if left is None else left
            _check_same_campaign(one, entries[:1], heading)
            ordered = list(_in_order(entries[1:], places))
            for key, entry in ordered:
                known[key] = Played(jobs[key], entry.outcome, entry.control)
            seconds += ordered[-1][1].seconds if ordered else 0.0
        journal.create(path, entries[: 1 + len(ordered)])
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}: remove it, or name another --out") from None
    chosen = [*jobs.values()] if shard is None else shard.of([*jobs.values()])
    return Unfinished(path, shards, chosen, known, seconds, shard)


def _in_order(
    entries: Sequence[bytes], places: Mapping[tuple[str, str], int]
) -> Iterator[tuple[tuple[str, str], _Entry]]:
    """The entries up to the first out of order, which appears if two processes write at once."""
    last = -1
    for entry in entries:
        one = msgspec.json.decode(entry, type=_Entry)
        key = (one.test, one.robot)
        if places.get(key, -1) <= last:
            return
        last = places[key]
        yield key, one


def _check_same_campaign(path: Path, heading: Sequence[bytes], wanted: _Heading) -> None:
    try:
        kept = msgspec.json.decode(b"".join(heading), type=_Heading)
    except msgspec.DecodeError:
        content = "no campaign: move it away"
    else:
        if kept.inputs == wanted.inputs:
            return
        content = f"another campaign, which `{kept.command}` finishes: remove it to give that up"
        if kept.command == wanted.command:
            content = (
                "this campaign before its tests, requirements or programs changed: remove it to "
                "start again"
            )
    raise RvmonError(f"{path} holds {content}, or name another --out")


def _inputs(plan: Plan, specs: Mapping[str, Spec]) -> str:
    campaign = plan.campaign
    return journal.checksum(
        [(job.robot, msgspec.to_builtins(job.test)) for job in plan.jobs()],
        {robot: to_plain(spec.checked) for robot, spec in specs.items()},
        [list(contents(path)) for path in sources_of(campaign)],
        [*map(_version, (*_PACKAGES, *campaign.packages))],
    )


def sources_of(campaign: Campaign) -> list[Path]:
    """The files and folders that outcomes depend on: those named, and those of its definitions."""
    makers = (
        campaign.test,
        *campaign.strategies.values(),
        *(robot.system for robot in campaign.robots.values()),
    )
    modules = {inspect.getmodule(maker) for maker in makers}
    files = {module.__file__ for module in modules if module is not None and module.__file__}
    models = (path for robot in campaign.robots.values() for path in robot.coverage)
    return [*map(Path, campaign.sources), *map(Path, sorted(files)), *map(Path, models)]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
