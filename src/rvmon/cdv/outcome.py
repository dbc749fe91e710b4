"""What a campaign keeps of each test, and of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.cdv.plan import Job, Plan
from rvmon.coverage.hits import Hits
from rvmon.coverage.model import Group
from rvmon.coverage.record import Ending
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out of one test.

    Attributes:
        verdicts: by requirement; empty if nothing was judged. Of a test that hung or was lost
            nothing is known: it is inconclusive.
        reasons: by requirement that failed, when and why it did first.
        illegal: what was hit of coverage models and must not be, in words.
        hits: of states, transitions, code, and of coverage models.
        ending: `completed`; `crashed` if code raised an exception, in which case it is judged as
            far as it went; `hung` if it was ended; `lost` if its process was.
        error: why it did not complete.
        end_ns: up to which it was judged.
        figures: what the system reports of the run, to be added up.
        seconds: wall time that it took.
    """

    verdicts: Mapping[str, Verdict]
    reasons: Mapping[str, str]
    illegal: tuple[str, ...]
    hits: Hits
    ending: Ending
    error: str | None
    end_ns: int
    figures: Mapping[str, float]
    seconds: float = field(compare=False)

    @property
    def simulated_s(self) -> float:
        """Simulated seconds."""
        return self.end_ns / 1e9


@dataclass(frozen=True, slots=True)
class Played:
    """One test that was played.

    Attributes:
        job: what was played.
        outcome: of it.
        control: the outcome of its control, if it has one.
    """

    job: Job
    outcome: Outcome
    control: Outcome | None = None


@dataclass(frozen=True, slots=True)
class Results:
    """What came out of a campaign.

    Attributes:
        plan: what was to be played.
        played: in the order of the plan, whichever process was first.
        seconds: wall time.
        cut_short: why not all tests were played; empty if they were.
        groups: what was measured beside what the campaign measures.
        unreachable: why items of the coverage model cannot be hit, by group and item, beside those
            of which the campaign says so.
    """

    plan: Plan
    played: tuple[Played, ...]
    seconds: float
    cut_short: str = ""
    groups: Sequence[Group] = ()
    unreachable: Mapping[tuple[str, str], str] = field(default_factory=dict)
