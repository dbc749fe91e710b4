"""What is open now: how many attempts, and the records of all or of the oldest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from heapq import nsmallest

from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.records.ledger import Ledger
from rvmon.verdict.attempt import Attempt


def owed_now(
    evaluators: Evaluators, ledger: Ledger, now: int, most: int | None
) -> tuple[Counter[str], Sequence[Attempt]]:
    """How many attempts of each requirement are open, and records.

    A record costs a tenth of a millisecond, as it words what is owed, and what is certain.

    Args:
        evaluators: of a monitor, taken along to now.
        ledger: of it.
        now: as in `Ledger.open_record`.
        most: so many records: of the oldest attempt of each requirement and instance, the oldest
            of these first; `None`: of all.
    """
    void = ledger.void_records
    counts = Counter(one.requirement for one in void)
    # In the order of the file and of triggers, whichever evaluator each is in.
    holding = [judge for judge in evaluators.judges if judge.attempts]
    holding.sort(key=lambda judge: (judge.compiled.rank, judge.rank, judge.hidden))
    for judge in holding:
        counts[judge.compiled.requirement.id] += len(judge.attempts)
    if most is None:
        own = ((judge, sorted(judge.attempts, key=_age)) for judge in holding)
        chosen = [(judge, attempt) for judge, attempts in own for attempt in attempts]
    else:
        oldest = [(judge, min(judge.attempts, key=_age)) for judge in holding]
        chosen = nsmallest(most, oldest, key=lambda one: _age(one[1]))
    return counts, [*(ledger.open_record(*one, now) for one in chosen), *void[:most]]


def _age(attempt: Open) -> int:
    return attempt.triggered
