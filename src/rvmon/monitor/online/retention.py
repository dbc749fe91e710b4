"""What is kept of a run that may last for weeks, and the counts of what is not."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import TypeVar

from rvmon.automaton.location import FAILED, PASSED
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.records.ledger import Ledger
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict, fold

_PATIENCE = 256
"""So much more may be there than is kept before somebody looks: a look costs what is there."""

_T = TypeVar("_T")


class Kept:
    """Bounds the records and the open attempts of a run that can only stay undecided.

    Args:
        ledger: has the records.
        keep: so many records of each verdict are kept per requirement; `None`: all.

    Attributes:
        dropped: by requirement, how many attempts were not kept, by verdict.
    """

    STATE = ("dropped", "_seen", "_seen_to")

    def __init__(self, ledger: Ledger, keep: int | None) -> None:
        self.dropped: dict[str, dict[Verdict, int]] = {}
        self._ledger = ledger
        self._keep = keep
        self._seen: dict[str, set[Verdict]] = {}
        self._seen_to = 0
        self._calls = 0
        self._limit = _PATIENCE

    def verdicts(self, requirements: Iterable[str]) -> Mapping[str, Verdict]:
        """The fold of the decided attempts; costs what was decided since the last call."""
        attempts = self._ledger.attempts
        for index in range(self._seen_to, len(attempts)):
            attempt = attempts[index]
            self._seen.setdefault(attempt.requirement, set()).add(attempt.verdict)
        self._seen_to = len(attempts)
        return {name: fold(self._seen.get(name, ())) for name in requirements}

    def bound(self, evaluators: Evaluators) -> None:
        """Drop what is too much, now and then; to be called after each flush of the ledger."""
        if self._keep is None:
            return
        # An attempt that only stays undecided brings no record, but a call.
        self._calls += 1
        if self._calls + self._size > self._limit:
            self._calls = 0
            self.tidy(evaluators)
            there = sum(len(holder.attempts) for _, holder, _ in evaluators.holders())
            self._limit = 2 * self._size + there + _PATIENCE

    @property
    def _size(self) -> int:
        return len(self._ledger.attempts) + len(self._ledger.void)

    def tidy(self, evaluators: Evaluators) -> None:
        """Drop all that is too much; see `bound`."""
        if self._keep is not None:
            self.trim()
            self._forget_lost(evaluators)

    def trim(self) -> None:
        """Drop the records that are too many; when the run is over, there are no others."""
        if self._keep is None:
            return
        self.verdicts(())
        ledger = self._ledger
        surplus = {id(one) for one in self._surplus((one, one) for one in ledger.attempts)}
        ledger.attempts[:] = [one for one in ledger.attempts if id(one) not in surplus]
        self._seen_to = len(ledger.attempts)
        surplus = {id(one) for one in self._surplus((one, one[2]) for one in ledger.void)}
        ledger.void[:] = [one for one in ledger.void if id(one) not in surplus]

    def _surplus(self, records: Iterable[tuple[_T, Attempt]]) -> list[_T]:
        """What is older than the newest of its kind that are kept; it is counted."""
        alike: dict[tuple[str, Verdict], list[tuple[int, _T]]] = defaultdict(list)
        for what, record in records:
            instant = record.triggered if record.decided is None else record.decided
            alike[record.requirement, record.verdict].append((instant, what))
        return [one for kind, found in alike.items() for one in self._oldest(*kind, found)]

    def _oldest(self, name: str, verdict: Verdict, found: list[tuple[int, _T]]) -> list[_T]:
        """All but the newest of what is given with its instant; they are counted."""
        surplus = len(found) - (self._keep or 0)
        if surplus <= 0:
            return []
        counts = self.dropped.setdefault(name, {})
        counts[verdict] = counts.get(verdict, 0) + surplus
        found.sort(key=lambda entry: entry[0])
        return [what for _, what in found[:surplus]]

    def _forget_lost(self, evaluators: Evaluators) -> None:
        """Drop the oldest of the open attempts that can only stay undecided."""
        lost: dict[str, list[tuple[int, Open]]] = defaultdict(list)
        for name, holder, running in evaluators.holders():
            own = (one for one in holder.attempts if one is not running and _is_lost(one))
            lost[name] += [(attempt.triggered, attempt) for attempt in own]
        gone = {
            id(attempt)
            for name, found in lost.items()
            for attempt in self._oldest(name, Verdict.INCONCLUSIVE, found)
        }
        for _, holder, _ in evaluators.holders() if gone else ():
            if any(id(one) in gone for one in holder.attempts):
                holder.attempts = [one for one in holder.attempts if id(one) not in gone]
        if gone:
            evaluators.instances.let_go()


def _is_lost(attempt: Open) -> bool:
    """Whether an attempt, not of an episode that runs, is `I` whatever comes.

    Unknown input has left it no way to pass. It has none to fail either, or cannot, being in doubt.
    """
    if attempt.token[0] != FAILED:
        return False
    return not attempt.sure or (attempt.better is not None and attempt.better[0] == PASSED)
