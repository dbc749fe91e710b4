"""What was played of a campaign that is not finished, in its folder: begun again, it goes on.

The file stays until the campaign's tables and pages are written. Nothing of it is taken if anything
that outcomes depend on has changed since: tests, requirements, programs.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import msgspec

import rvmon
from rvmon.cache import file_stamps
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.outcome import Outcome, Played
from rvmon.cdv.plan import Job, Plan
from rvmon.errors import RvmonError
from rvmon.execute import journal
from rvmon.session import Spec
from rvmon.spec.checked.plain_data import to_plain

NAME = "unfinished.journal"
"""The file in a campaign's folder."""

_PACKAGES = ("coverage", "msgspec", "numpy")
"""Those that have a part in any outcome."""


@dataclass(frozen=True, slots=True)
class _Entry:
    """One test that was played, and the seconds that the campaign had taken by then."""

    test: str
    robot: str
    outcome: Outcome
    control: Outcome | None
    seconds: float


@dataclass(frozen=True, slots=True)
class _Heading:
    """The first entry: a checksum of what outcomes depend on, and what a person can type."""

    inputs: str
    command: str


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A campaign that goes on.

    Attributes:
        path: of its file.
        played: what was played before, in the order of the plan.
        seconds: that this took.
    """

    path: Path
    played: Sequence[Played] = ()
    seconds: float = 0.0

    def keep(self, one: Played, seconds: float) -> None:
        """Write down what was played: it stays, whatever ends this process.

        Args:
            one: a test.
            seconds: that the campaign has taken by now.
        """
        entry = _Entry(one.job.test.name, one.job.robot, one.outcome, one.control, seconds)
        journal.add(self.path, msgspec.json.encode(entry))


def unfinished(folder: Path, plan: Plan, specs: Mapping[str, Spec], command: str) -> Unfinished:
    """A campaign in its folder, from where it was left.

    Args:
        folder: of the campaign.
        plan: what it plays.
        specs: by robot, what judges it; empty if nothing is judged.
        command: that runs it.

    Raises:
        RvmonError: what is unfinished there is another campaign.
    """
    path = folder / NAME
    own = _Heading(_inputs(plan, specs), command)
    try:
        known = journal.entries(path)
        if known is None:
            known = [msgspec.json.encode(own)]
        else:
            _refuse_another(path, known[:1], own)
        entries = list(_in_order(known[1:], plan.jobs()))
        journal.begin(path, known[: 1 + len(entries)])
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}: remove it, or name another --out") from None
    played = [
        Played(job, one.outcome, one.control)
        for job, one in zip(plan.jobs(), entries, strict=False)
    ]
    return Unfinished(path, played, entries[-1].seconds if entries else 0.0)


def _in_order(entries: Sequence[bytes], jobs: Sequence[Job]) -> Iterator[_Entry]:
    """What was played, up to the first that is not in its place: two may have written at once."""
    for entry, job in zip(entries, jobs, strict=False):
        one = msgspec.json.decode(entry, type=_Entry)
        if (one.test, one.robot) != (job.test.name, job.robot):
            return
        yield one


def _refuse_another(path: Path, heading: Sequence[bytes], own: _Heading) -> None:
    try:
        found = msgspec.json.decode(b"".join(heading), type=_Heading)
    except msgspec.DecodeError:
        told = "no campaign: move it away"
    else:
        if found.inputs == own.inputs:
            return
        told = f"another campaign, which `{found.command}` finishes: remove it to give that up"
        if found.command == own.command:
            told = (
                "this campaign before its tests, requirements or programs changed: remove it to "
                "begin anew"
            )
    raise RvmonError(f"{path} holds {told}, or name another --out")


def _inputs(plan: Plan, specs: Mapping[str, Spec]) -> str:
    """A checksum of all that outcomes depend on."""
    campaign = plan.campaign
    said = [
        [(job.robot, msgspec.to_builtins(job.test)) for job in plan.jobs()],
        {robot: to_plain(spec.checked) for robot, spec in specs.items()},
        [list(_stamps(path)) for path in (Path(rvmon.__file__).parent, *sources_of(campaign))],
        [sys.version, *map(_version, (*_PACKAGES, *campaign.packages))],
    ]
    return hashlib.sha256(json.dumps(said).encode()).hexdigest()


def sources_of(campaign: Campaign) -> list[Path]:
    """What outcomes of a campaign depend on: files and folders that it names, or is defined in."""
    makers = (
        campaign.test,
        *campaign.strategies.values(),
        *(robot.system for robot in campaign.robots.values()),
    )
    modules = {inspect.getmodule(one) for one in makers}
    files = {module.__file__ for module in modules if module is not None and module.__file__}
    models = (path for robot in campaign.robots.values() for path in robot.coverage)
    return [*map(Path, campaign.sources), *map(Path, sorted(files)), *map(Path, models)]


def _stamps(path: Path) -> Iterator[tuple[str, int, int]]:
    if path.is_dir():
        yield from file_stamps(str(path))
    else:
        found = path.stat()
        yield str(path), found.st_size, found.st_mtime_ns


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
