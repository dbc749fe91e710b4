"""A judged run with all that its page shows: data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.report.markup import Child
from rvmon.report.scene import Scene
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class JudgedRun:
    """A run with its verdicts.

    Attributes:
        name: what people call it, such as a test's name or a file's.
        report: the verdicts.
        samples: that were judged, in time order; empty if they were not kept.
    """

    name: str
    report: Report
    samples: Sequence[Sample]


@dataclass(frozen=True, slots=True)
class RunPage:
    """What the page of a run is made of.

    Attributes:
        run: the one that the page is about.
        spec: that judged it.
        command: replays it.
        others: runs by the same spec, whose passing attempts a failed one can be held against.
        facts: more about the run, as pairs of name and value.
        scene: what the robot did, if it is known.
        back: address of the page that links here.
    """

    run: JudgedRun
    spec: CheckedSpec
    command: str
    others: Sequence[JudgedRun] = ()
    facts: Sequence[tuple[str, Child]] = ()
    scene: Scene | None = None
    back: str = ""
