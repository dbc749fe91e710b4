"""Attempts become a report: order, counts and the fold per requirement."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence

from rvmon.trace.health import Health
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

_ATTEMPT_VERDICTS = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)


def report_of(
    requirements: Sequence[str],
    attempts: Iterable[Attempt],
    *,
    dropped: Mapping[str, Mapping[Verdict, int]] | None = None,
    health: Sequence[Health] = (),
    untold: Collection[str] = (),
    trace: str = "",
    origin: int = 0,
    end: int | None = None,
) -> Report:
    """Sort, count and fold the attempts of one run.

    Args:
        requirements: all ids that were judged, in the order of the file.
        attempts: of these requirements, in any order.
        dropped: by requirement, how many attempts more there were, by verdict.
        health: findings about the input.
        untold: the ids of those whose trigger was never true or false: without attempts, they are
            inconclusive.
        trace: name of the recording.
        origin: the instant from which people count seconds, ticks.
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
    not_kept = {name: {**found} for name, found in (dropped or {}).items()}
    by_requirement = {name: Counter(not_kept.get(name)) for name in requirements}
    for attempt in ordered:
        by_requirement[attempt.requirement][attempt.verdict] += 1
    return Report(
        verdicts={
            name: fold(seen, told=name not in untold) for name, seen in by_requirement.items()
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
