"""Whole recordings judged by columns."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping, Sequence, Set
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.decided import DecidedAttempts
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError
from rvmon.monitor.columns.records import JudgedAttempts
from rvmon.monitor.columns.rule import ColumnRule
from rvmon.monitor.columns.timeline import Timeline
from rvmon.monitor.compiled.code_plan import plan_requirements
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.health import Arrivals, HealthLog, holds_nan
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outage, Outages
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import HealthKind
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 19
"""Rows that are judged together: temporary arrays do not grow with the recording."""

_ATTEMPT_VERDICTS = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)


class ColumnJudge:
    """Judges requirements by columns: those that `rvmon.monitor.compiled.refusal.of_columns` lets.

    Attributes:
        ids: of the requirements that this judges.
    """

    def __init__(
        self,
        compiled: CompiledSpec,
        chosen: Sequence[str],
        ids: frozenset[str],
        names: frozenset[str],
    ) -> None:
        self.ids = ids
        self._chosen = compiled.chosen(chosen)
        own = [one for one in self._chosen if one.requirement.id in ids]
        plan = plan_requirements(compiled, own)
        self._ledger = Ledger()
        self._rules = [ColumnRule(one, plan, self._ledger) for one in own]
        self._hidden = [
            ColumnRule(one.hidden, plan, self._ledger, hidden=True)
            for one in own
            if one.hidden is not None
        ]
        asked = frozenset[int]().union(*(rule.nodes for rule in self._all_rules))
        self._stale: dict[str, int] = {}
        """Signals with the time after which they become stale, where that shows by itself."""
        if plan.gap is not None:
            for name in names & compiled.checked.signals.keys():
                bound = compiled.checked.signals[name].stale_after
                if bound is not None:
                    self._stale[name] = bound
        self._timeline = Timeline(plan, names, asked)
        self._ignoring = compiled.checked.ignoring
        self._health = HealthLog()
        self._absent = frozenset({*compiled.checked.signals, *compiled.checked.events} - names)
        self._expired: dict[str, tuple[int, int]] = {}
        self._outages = ColumnOutages(compiled.checked, names)
        self._last: int | None = None

    def take(self, times: NDArray[np.int64], columns: Columns) -> None:
        """Judge rows, a piece at a time.

        Args:
            times: int64[n] ticks, later than all before, ascending.
            columns: by name, of the same length.

        Raises:
            NotByColumnsError: something in them has to be judged sample by sample.
        """
        for start in range(0, len(times), CHUNK):
            own = times[start : start + CHUNK]
            self._note_stale(own if self._last is None else np.append(self._last, own))
            piece = {name: column[start : start + CHUNK] for name, column in columns.items()}
            if any(holds_nan(piece[name]) for name in self._ignoring & piece.keys()):
                raise NotByColumnsError
            self._health.count_columns(own, piece)
            self._outages.take(own, piece)
            made = self._timeline.take(own, piece)
            for rule in self._all_rules:
                rule.take(made, int(own[-1]))
            self._last = int(own[-1])
        if self._health.began is None and len(times):
            self._health.began = int(times[0])

    @property
    def _all_rules(self) -> Sequence[ColumnRule]:
        return [*self._rules, *self._hidden]

    @property
    def began(self) -> bool:
        """Whether there was a row."""
        return self._last is not None

    def _note_stale(self, times: NDArray[np.int64]) -> None:
        """Note where signals become stale between neighbouring instants of updates."""
        for name, bound in self._stale.items():
            found = times[:-1][np.diff(times) > bound + 1] + (bound + 1)
            if len(found):
                count, first = self._expired.get(name, (0, int(found[0])))
                self._expired[name] = (count + len(found), first)

    def report(self, until: int | None, others: Report | None) -> Report:
        """End the trace and judge it; there has been a row.

        Args:
            until: its end in ticks, if after the last row.
            others: on the requirements that something else judged.
        """
        last = self._last or 0
        end = last if until is None else max(last, until)
        piece = self._timeline.last_piece(end)
        for rule in self._all_rules:
            rule.take(piece, end)
            stands_at = last if piece.axis.start == piece.axis.stop else piece.axis.stop - 1
            rule.finish(self._timeline, end, stands_at, self._outages.at)
        kept = [*self._ledger.close(), *(() if others is None else others.attempts)]
        self._note_stale(np.array([last, end + 1]))
        health = self._health.report(self._chosen, Arrivals(self._absent, {}, self._expired), None)
        ids = [one.requirement.id for one in self._chosen]
        attempts, found = _assembled(ids, self._rules, kept)
        determined = {rule.id: rule.is_determined for rule in self._rules}
        verdicts = {} if others is None else dict(others.verdicts)
        return Report(
            verdicts={
                name: verdicts.get(name)
                or fold((one for one, count in counts.items() if count), complete=determined[name])
                for name, counts in found.items()
            },
            attempts=attempts,
            counts={
                name: {verdict: counts[verdict] for verdict in _ATTEMPT_VERDICTS}
                for name, counts in found.items()
            },
            health=self._health.alternations.remarked(health),
            origin=self._health.began or 0,
            end=end,
        )


def _assembled(
    ids: Sequence[str], rules: Sequence[ColumnRule], kept: Sequence[Attempt]
) -> tuple[JudgedAttempts, Mapping[str, Counter[Verdict]]]:
    """All attempts in the order of reports, and the count of their verdicts by requirement."""
    rank = {name: index for index, name in enumerate(ids)}
    counts = {name: Counter[Verdict]() for name in ids}
    parts = []
    for rule in rules:
        own = rule.decided()
        parts.append((rank[rule.id], own))
        passed = int(np.count_nonzero(own.decisions.passed))
        counts[rule.id] += Counter({Verdict.PASS: passed, Verdict.FAIL: len(own) - passed})
    others = []
    for one in kept:
        counts[one.requirement][one.verdict] += 1
        decided = FAR if one.decided is None else one.decided
        others.append((decided, rank[one.requirement], one.in_doubt, one.number))
    return JudgedAttempts([own for _, own in parts], kept, _order(parts, others)), counts


def _order(
    parts: Sequence[tuple[int, DecidedAttempts]], others: Sequence[tuple[int, int, bool, int]]
) -> NDArray[np.int64]:
    """The numbers of attempts by instant of decision, requirement and number.

    Args:
        parts: attempts that were decided, with the rank of their requirement.
        others: of the other attempts the instant, the rank, whether in doubt, and the number.
    """
    keys = np.array(others, np.int64).reshape(-1, 4)
    decided = np.concatenate([*(part.decisions.decided for _, part in parts), keys[:, 0]])
    if bool((decided[1:] > decided[:-1]).all()):
        return np.arange(len(decided))
    number = np.concatenate([*(part.decisions.number for _, part in parts), keys[:, 3]])
    in_doubt = np.concatenate([np.zeros(len(decided) - len(keys), np.int64), keys[:, 2]])
    ranks = np.concatenate([*(np.full(len(part), rank) for rank, part in parts), keys[:, 1]])
    return np.lexsort((number, in_doubt, ranks, decided))


class ColumnOutages:
    """The outages of columns in which every row updates every signal.

    What becomes stale is read by no requirement that columns are asked for.
    """

    def __init__(self, spec: CheckedSpec, names: Set[str]) -> None:
        self._signals = sorted(names & spec.signals.keys())
        self._known = Outages(spec, names)
        self._seen: dict[str, list[Outage]] = {name: [one] for name, one in self._known.now.items()}

    def take(self, times: NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> None:
        """Look through rows.

        Args:
            times: int64[n] ticks, later than all before.
            columns: by name, of the same length.
        """
        for name in self._signals:
            column = columns[name]
            lost = np.zeros(len(times), bool)
            if column.dtype.kind == "f":
                lost = np.isnan(column)
            turns = np.diff(lost, prepend=not lost[0])
            for row in np.flatnonzero(turns).tolist():
                self._row(name, int(times[row]), lost=bool(lost[row]))

    def at(self, t: int) -> Mapping[str, Outage]:
        """By name what was not known at an instant."""
        found = {}
        for name, seen in self._seen.items():
            place = bisect_right(seen, t, key=_since) - 1
            if place >= 0 and (seen[place].until is None or t < (seen[place].until or 0)):
                found[name] = seen[place]
        return found

    def _row(self, name: str, t: int, *, lost: bool) -> None:
        if not lost:
            self._known.found(name, t)
        elif name not in self._known.now:
            self._known.lost(name, t, HealthKind.NAN.value)
            self._seen.setdefault(name, []).append(self._known.now[name])


def _since(outage: Outage) -> int:
    """Before the first value, a signal was never known."""
    first = outage.why in (HealthKind.MISSING, HealthKind.ABSENT)
    return -TIME_LIMIT if first else outage.since
