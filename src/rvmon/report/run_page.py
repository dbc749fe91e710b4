"""A judged run with all that its page shows, attempt by attempt: data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.explain.dissect import Strand
from rvmon.report.markup import Child
from rvmon.report.scene import Scene
from rvmon.report.timeline import Ghost
from rvmon.report.tracks import Track
from rvmon.report.view import View
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


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


@dataclass(frozen=True, slots=True)
class Panel:
    """What a page shows of one attempt.

    Attributes:
        id: of the element on the page, and its address behind `#`.
        requirement: its id.
        attempt: `None` if there is none.
        verdict: of the attempt, or of a requirement without any.
        view: the stretch of time that is shown.
        tracks: of the signals and events concerned.
        ghost: the nearest passing attempt, for a failed one.
        strands: the truth of each part of the requirement over the view; empty if that would take
            too long.
        late: when what the attempt had awaited came after its deadline, ticks; `None`: it did not.
        miss: without an attempt, what the trigger lacked when it was nearest.
    """

    id: str
    requirement: str
    attempt: Attempt | None
    verdict: Verdict
    view: View
    tracks: tuple[Track, ...]
    ghost: Ghost | None
    strands: tuple[Strand, ...] = ()
    late: int | None = None
    miss: str = ""

    @property
    def instant(self) -> int:
        """Where the cursor stands at first: at the decision, else at the trigger."""
        if self.attempt is None:
            return self.view.start
        return self.attempt.triggered if self.attempt.decided is None else self.attempt.decided
