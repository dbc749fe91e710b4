"""How a robot that is watched stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Status:
    """A robot at an instant.

    Attributes:
        robot: its name; empty if there is one only.
        run: the number of the run that is under way, from 1.
        since: the instant of its first sample, ns; `None` before it.
        now: the instant to which time has come, ns.
        verdicts: of each requirement so far, over all runs.
        counts: how many attempts of a requirement had a verdict since it is watched.
        owed: how many attempts of each requirement are open now; those without any may lack.
        open: their records with their deadlines: all, or as many as were asked for.
        samples: so many were judged, over all runs.
        lost: so many were not.
        refusal: why the latest that was refused was.
    """

    robot: str
    run: int
    since: int | None
    now: int
    verdicts: Mapping[str, Verdict]
    counts: Counter[tuple[str, Verdict]]
    owed: Mapping[str, int]
    open: tuple[Attempt, ...]
    samples: int
    lost: int
    refusal: str
