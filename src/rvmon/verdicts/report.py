"""The report of one run: its attempts, and the counts and verdict of each requirement."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

from rvmon.errors import UnknownNameError
from rvmon.texts import did_you_mean
from rvmon.trace.sample import Health, HealthKind
from rvmon.verdicts import LAW, Verdict, fold
from rvmon.verdicts.attempt import Attempt, LazyAttempts
from rvmon.verdicts.run_coverage import CoveredGroup, IllegalHit

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

    from rvmon.language.checked.specification import Requirement
    from rvmon.verdicts.serialise import VerdictRow

_ATTEMPT_VERDICTS = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)


@dataclass(frozen=True, slots=True, repr=False)
class Report:
    """All verdicts on one run; made by `report_of`.

    Attributes:
        verdicts: by requirement, in the order of the file; those never triggered are `NT`.
        attempts: the decided attempts by decision instant, then order in the file, then number;
            the undecided attempts follow in the order of the file and by number.
        counts: by requirement, the number of its attempts by verdict: `P`, `F` and `I`.
        health: the unknown parts of the input, with reasons.
        trace: name of the recording, or ""; `==` ignores it.
        origin: the instant that is shown as 0 s, ticks.
        end: the last instant of the trace, ticks; `None` if it has no position.
        misses: by requirement without attempts, how close its trigger came to being true; if
            computed.
        late: by requirement and number of the attempt, the instant of a response after the
            deadline, ticks; if computed.
        values: by requirement and number of the attempt, the values of the signals that the blamed
            subformula reads, with units, at the decision; for the first failures, if computed.
        goals: by cover goal, `P` if the run shows it, `I` if it was still possible at the end, else
            `NT`; if computed.
        illegal: the illegal bins and combinations that were hit; if computed.
        coverage: the hits of coverpoints and crosses; if computed.
        law: version of the semantics; a stored report may have an older one.
        dropped: by requirement and verdict, the number of attempts whose records were not kept,
            because of `keep` or because a long gap in the input made thousands of attempts fail by
            time alone. Verdicts and counts include them; no count exceeds 4,294,967,295.
    """

    verdicts: Mapping[str, Verdict]
    attempts: Sequence[Attempt]
    counts: Mapping[str, Mapping[Verdict, int]]
    health: tuple[Health, ...] = ()
    trace: str = field(default="", compare=False)
    origin: int = 0
    end: int | None = None
    misses: Mapping[str, str] = field(default_factory=dict)
    late: Mapping[str, Mapping[int, int]] = field(default_factory=dict)
    values: Mapping[str, Mapping[int, Mapping[str, str]]] = field(default_factory=dict)
    goals: Mapping[str, Verdict] = field(default_factory=dict)
    illegal: tuple[IllegalHit, ...] = ()
    coverage: tuple[CoveredGroup, ...] = ()
    law: int = LAW
    dropped: Mapping[str, Mapping[Verdict, int]] = field(default_factory=dict)
    _kinds: dict[tuple[str, Verdict], list[Attempt]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    _repr_html_: ClassVar[Callable[[Report], str]]
    """HTML for notebooks; set by `rvmon.session`, because `report` is a layer above this one."""

    def __repr__(self) -> str:
        verdicts = ", ".join(f"{name} {verdict}" for name, verdict in self.verdicts.items())
        of = f" of {self.trace}" if self.trace else ""
        return f"<Report{of}: {verdicts}>"

    @property
    def absent(self) -> frozenset[str]:
        """The signals and events that had no source."""
        return frozenset(health.name for health in self.health if health.kind is HealthKind.ABSENT)

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """The attempts of one requirement with one verdict, in order.

        Args:
            requirement: its id.
            verdict: `P`, `F` or `I`.

        Raises:
            UnknownNameError: there is no such requirement, or no such verdict.
        """
        if requirement not in self.verdicts:
            there_are = f"there are {', '.join(self.verdicts) or 'none'}"
            meant = did_you_mean(requirement, self.verdicts, there_are)
            raise UnknownNameError(f"no requirement `{requirement}`: {meant}")
        if verdict not in _ATTEMPT_VERDICTS:
            raise UnknownNameError(f"no attempt has the verdict {verdict!r}: one has P, F or I")
        if isinstance(self.attempts, LazyAttempts):
            return self.attempts.of(requirement, verdict)
        if not self._kinds:
            for attempt in self.attempts:
                self._kinds.setdefault((attempt.requirement, attempt.verdict), []).append(attempt)
        return iter(self._kinds.get((requirement, verdict), ()))

    def is_silent(self, requirement: str) -> bool:
        """Whether a requirement has no attempt: it is `NT`, or `I` if its trigger was unknown."""
        return not any(self.counts[requirement].values())

    def rows(self) -> Iterator[VerdictRow]:
        """The report as rows: its attempts in order, then the requirements without attempts.

        The verdict of a requirement is the worst of its rows: `F`, else `I`, else `P`, else `NT`.

        >>> passed = Attempt("R1", 1, 0, 5, Verdict.PASS)
        >>> for row in report_of(["R1", "R2"], [passed], trace="a.csv").rows():
        ...     print(row.recording, row.requirement, row.attempt, row.verdict)
        a.csv R1 R1#1 P
        a.csv R2 None NT
        """
        from rvmon.verdicts.serialise import VerdictRow, attempt_row

        for attempt in self.attempts:
            yield attempt_row(self.trace, attempt)
        for name, verdict in self.verdicts.items():
            verdicts = [verdict for verdict, count in self.counts[name].items() if count]
            # No attempts, or the trigger was unknown, so that there may have been more.
            if not verdicts or fold(verdicts) is not verdict:
                reason = self.misses.get(name, "")
                yield VerdictRow(self.trace, name, verdict=verdict.value, reason=reason)

    def to_arrow(self) -> pyarrow.Table:
        """The report as an Arrow table of `rows`; `VerdictRow` describes the columns.

        Raises:
            RvmonError: pyarrow (`rvmon[arrow]`) is not installed.

        >>> report = report_of(["R1"], [Attempt("R1", 1, 0, 5, Verdict.PASS)], trace="a.csv")
        >>> report.to_arrow().select(["attempt", "verdict", "decided"]).to_pylist()
        [{'attempt': 'R1#1', 'verdict': 'P', 'decided': 5}]
        """
        from rvmon.verdicts.serialise import arrow_table

        return arrow_table(self.rows(), {"law": str(self.law)})

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a pandas data frame; instants are the nullable `Int64`.

        Raises:
            RvmonError: pyarrow or pandas is not installed.
        """
        from rvmon.verdicts.serialise import pandas_frame

        return pandas_frame(self.to_arrow())

    def to_polars(self) -> polars.DataFrame:
        """The rows as a polars data frame.

        Raises:
            RvmonError: pyarrow or polars is not installed.
        """
        from rvmon.verdicts.serialise import polars_frame

        return polars_frame(self.to_arrow())

    def to_json(self, requirements: Mapping[str, Requirement] | None = None) -> str:
        """The report as JSON text, as `rvmon run --format json` prints it.

        Infinite captured values and robustnesses become null, as JSON has no infinities.

        Args:
            requirements: `Spec.requirements`, to include severity and tags.
        """
        from rvmon.verdicts.serialise import encoded, labels, packed

        attempts: dict[str, list[object]] = {name: [] for name in self.verdicts}
        for attempt in self.attempts:
            attempts[attempt.requirement].append(packed(attempt))
        members = {"goals": self.goals, "illegal": self.illegal, "coverage": self.coverage}
        return encoded(
            {
                "law": self.law,
                "trace": self.trace,
                "origin": self.origin,
                "end": self.end,
                "requirements": {
                    name: {
                        "verdict": verdict,
                        "attempts": attempts[name],
                        **self._rest_of(name),
                        **labels((requirements or {}).get(name)),
                    }
                    for name, verdict in self.verdicts.items()
                },
                "health": self.health,
                **{name: some for name, some in members.items() if some},
            }
        )

    def _rest_of(self, requirement: str) -> dict[str, object]:
        """The JSON members of a requirement that follow its attempts."""
        members = {
            "dropped": self.dropped,
            "nearest_miss": self.misses,
            "late": self.late,
            "values": self.values,
        }
        rest = {
            name: of_requirement[requirement]
            for name, of_requirement in members.items()
            if of_requirement.get(requirement)
        }
        return {"counts": self.counts[requirement], **rest}

    @classmethod
    def from_json(cls, text: str | bytes) -> Report:
        """Read a report written by `to_json`.

        Verdicts and counts are recomputed from the attempts and the numbers of dropped attempts.

        Raises:
            TraceError: the text is not a report.
        """
        from rvmon.verdicts.serialise import decode

        document, attempts = decode(text)
        entries = document.requirements.items()
        report = report_of(
            tuple(document.requirements),
            attempts,
            dropped={
                name: {Verdict(verdict): count for verdict, count in entry.dropped.items()}
                for name, entry in entries
                if entry.dropped
            },
            health=document.health,
            incomplete=[name for name, entry in entries if entry.verdict is Verdict.INCONCLUSIVE],
            trace=document.trace,
            origin=document.origin,
            end=document.end,
        )
        misses = {name: entry.nearest_miss for name, entry in entries if entry.nearest_miss}
        late = {name: entry.late for name, entry in entries if entry.late}
        return replace(
            report,
            misses=misses,
            late=late,
            values={name: entry.values for name, entry in entries if entry.values},
            goals=document.goals,
            illegal=document.illegal,
            coverage=document.coverage,
            law=document.law,
        )


def report_of(
    requirements: Sequence[str],
    attempts: Iterable[Attempt],
    *,
    dropped: Mapping[str, Mapping[Verdict, int]] | None = None,
    health: Sequence[Health] = (),
    incomplete: Collection[str] = (),
    trace: str = "",
    origin: int = 0,
    end: int | None = None,
) -> Report:
    """Sort, count and fold the attempts of one run.

    Args:
        requirements: the ids of all judged requirements, in the order of the file.
        attempts: their attempts, in any order.
        dropped: by requirement and verdict, the number of further attempts, which have no record.
        health: findings about the input.
        incomplete: ids of the requirements whose trigger was never TRUE or FALSE. As attempts may
            be missing, they are `I`, unless an attempt failed.
        trace: name of the recording.
        origin: the instant that is shown as 0 s, ticks.
        end: the last instant of the trace, ticks.

    Source: SEMANTICS, section 3.

    >>> passed = Attempt("R1", 1, 0, 5, Verdict.PASS)
    >>> report = report_of(["R1", "R2"], [passed])
    >>> {name: verdict.value for name, verdict in report.verdicts.items()}
    {'R1': 'P', 'R2': 'NT'}
    """
    rank = {name: index for index, name in enumerate(requirements)}

    def order(attempt: Attempt) -> tuple[bool, int, int, bool, int]:
        decided, place = attempt.decided, rank[attempt.requirement]
        return (decided is None, decided or 0, place, attempt.in_doubt, attempt.number)

    ordered = tuple(sorted(attempts, key=order))
    not_kept = {name: {**counts} for name, counts in (dropped or {}).items()}
    by_requirement = {name: Counter(not_kept.get(name)) for name in requirements}
    for attempt in ordered:
        by_requirement[attempt.requirement][attempt.verdict] += 1
    return Report(
        verdicts={
            name: fold(seen, complete=name not in incomplete)
            for name, seen in by_requirement.items()
        },
        attempts=ordered,
        counts={
            name: {verdict: seen[verdict] for verdict in _ATTEMPT_VERDICTS}
            for name, seen in by_requirement.items()
        },
        dropped=not_kept,
        health=tuple(health),
        trace=trace,
        origin=origin,
        end=end,
    )
