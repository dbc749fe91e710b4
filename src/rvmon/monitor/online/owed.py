"""What is open now: how many attempts, and the records of all or of the oldest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from heapq import nsmallest

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
    holding = [judge for judge in evaluators.judges if judge.attempts]
    holding.sort(key=lambda judge: judge.compiled.rank)  # whichever evaluator each is in
    for judge in holding:
        counts[judge.compiled.requirement.id] += len(judge.attempts)
    if most is None:
        chosen = [(judge, attempt) for judge in holding for attempt in judge.attempts]
    else:
        first = nsmallest(most, holding, key=lambda judge: judge.attempts[0].triggered)
        chosen = [(judge, judge.attempts[0]) for judge in first]
    return counts, [*(ledger.open_record(*one, now) for one in chosen), *void[:most]]
