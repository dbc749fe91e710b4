"""What was played of a campaign that is not finished, in its folder: begun again, it goes on.

The file stays until the campaign's tables and pages are written. Nothing of it is taken if anything
that outcomes depend on has changed since: tests, requirements, programs.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import msgspec

import rvmon
from handover.campaign.outcome import Outcome
from handover.campaign.plan import Job, Plan
from rvmon.cache import file_stamps
from rvmon.errors import RvmonError
from rvmon.execute import journal
from rvmon.session import Spec
from rvmon.spec.checked.plain_data import to_plain

NAME = "unfinished.journal"
"""The file in a campaign's folder."""

_OURS = (Path(rvmon.__file__).parent, Path(__file__).parents[1])
_OTHERS = ("coverage", "numpy", "pymunk")
"""The packages that have a part in an outcome."""


@dataclass(frozen=True, slots=True)
class Played:
    """One test that was played.

    Attributes:
        outcomes: of the test; a second one is without the fitted loss of signals.
        seconds: that the campaign had taken by then.
    """

    outcomes: Sequence[Outcome]
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
    """

    path: Path
    played: Sequence[Played] = ()

    def keep(self, one: Played) -> None:
        """Write down what was played: it stays, whatever ends this process."""
        journal.add(self.path, msgspec.json.encode(one))


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
        played = list(_in_order(known[1:], plan.jobs()))
        journal.begin(path, known[: 1 + len(played)])
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}: remove it, or name another --out") from None
    return Unfinished(path, played)


def _in_order(entries: Sequence[bytes], jobs: Sequence[Job]) -> Iterator[Played]:
    """What was played, up to the first that is not in its place: two may have written at once."""
    for entry, job in zip(entries, jobs, strict=False):
        one = msgspec.json.decode(entry, type=Played)
        if one.outcomes[0].job != job:
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
    said = [
        msgspec.to_builtins(plan.jobs()),
        {robot: to_plain(spec.checked) for robot, spec in specs.items()},
        [list(file_stamps(str(folder))) for folder in _OURS],
        [sys.version, *map(version, _OTHERS)],
    ]
    return hashlib.sha256(json.dumps(said).encode()).hexdigest()
