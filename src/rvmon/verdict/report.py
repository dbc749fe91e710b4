"""What a monitor says of one run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.trace.health import Health
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.lazy import LazyAttempts
from rvmon.verdict.verdict import LAW, Verdict


@dataclass(frozen=True, slots=True)
class Report:
    """All verdicts on one run; made by `rvmon.verdict.assemble.report_of`.

    Attributes:
        verdicts: by requirement, in the order of the file; those never triggered are `NT`.
        attempts: the decided ones by decision instant, then order in the file, then number; the
            undecided ones follow in the order of the file and by number.
        counts: by requirement, how many of its attempts are `P`, `F` and `I`.
        health: what was not known of the input, and why.
        trace: name of the recording, or empty.
        origin: the instant from which people count seconds, ticks.
        end: the last instant of the trace, ticks; `None` if it has no position.
        misses: by requirement without attempts, what its trigger lacked when it was nearest; where
            somebody looked.
        late: by requirement and number of the attempt, when what it had awaited came after its
            deadline, ticks; where somebody looked.
        goals: of each cover goal `P` if the run shows it, `I` if it was still possible at its end,
            else `NT`; where somebody looked.
        law: version of the law that judged; a report that was kept may be of an older one.
        engine: the engines that judged, the fastest first; no part of what was judged, and so
            neither compared nor written down.
        dropped: by requirement, how many of its attempts were not kept, by verdict; verdicts and
            counts speak of them as well.
    """

    verdicts: Mapping[str, Verdict]
    attempts: Sequence[Attempt]
    counts: Mapping[str, Mapping[Verdict, int]]
    health: tuple[Health, ...] = ()
    trace: str = ""
    origin: int = 0
    end: int | None = None
    misses: Mapping[str, str] = field(default_factory=dict)
    late: Mapping[str, Mapping[int, int]] = field(default_factory=dict)
    goals: Mapping[str, Verdict] = field(default_factory=dict)
    law: int = LAW
    dropped: Mapping[str, Mapping[Verdict, int]] = field(default_factory=dict)
    engine: str = field(default="", compare=False)

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """The attempts of one requirement with one verdict, in their order.

        Args:
            requirement: its id.
            verdict: `P`, `F` or `I`.
        """
        if isinstance(self.attempts, LazyAttempts):
            return self.attempts.of(requirement, verdict)
        return (
            attempt
            for attempt in self.attempts
            if attempt.requirement == requirement and attempt.verdict is verdict
        )

    def is_silent(self, requirement: str) -> bool:
        """Whether a requirement has no attempt: it is `NT`, or `I` if its trigger was never known.

        Args:
            requirement: its id.
        """
        return not any(self.counts[requirement].values())

    def to_json(self) -> str:
        """The report as JSON text, in the shape that `rvmon run --format json` prints.

        JSON knows no infinities: such captured values and robustnesses become null.
        """
        from rvmon.verdict.report_json import encode

        return encode(self)

    @classmethod
    def from_json(cls, text: str | bytes) -> Report:
        """Read back what `to_json` wrote.

        Raises:
            TraceError: the text is no report.
        """
        from rvmon.verdict.report_json import decode

        return decode(text)
