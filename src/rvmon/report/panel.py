"""One attempt, or a requirement without any, ready to be drawn: data."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.explain.anatomy import Strand
from rvmon.report.timeline import Ghost
from rvmon.report.tracks import Track
from rvmon.report.view import View
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


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
