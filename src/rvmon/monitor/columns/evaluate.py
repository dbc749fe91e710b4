"""Whole recordings judged by columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rvmon.codegen.plan import Plan
from rvmon.dataflow.inputs import Inputs
from rvmon.dataflow.numbers import events_of
from rvmon.formula.state import Leaf
from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError
from rvmon.monitor.columns.moves import Moves, moves_of
from rvmon.monitor.columns.records import DecidedAttempts, JudgedAttempts
from rvmon.monitor.columns.rule import ColumnRule
from rvmon.monitor.columns.timeline import Timeline
from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec
from rvmon.monitor.generated import can_generate, plan_requirements
from rvmon.monitor.health import HealthLog
from rvmon.monitor.ledger import Ledger
from rvmon.spec.checked import Compare, Probe, ProbeAtom
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 19
"""Rows that are judged together: temporary arrays do not grow with the recording."""

_ATTEMPT_VERDICTS = (Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE)

_MOST_LEAVES = 39
"""So many truth values fit into a number of 64 bits."""


class ColumnJudge:
    """Judges requirements by columns; see `columns_judge` for which.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        plan: of these.
        moves: of their automata.
        names: of the columns.
    """

    def __init__(
        self,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        plan: Plan,
        moves: Sequence[Moves],
        names: frozenset[str],
    ) -> None:
        self._compiled = compiled
        self._requirements = requirements
        self._ledger = Ledger()
        self._rules = [
            ColumnRule(one, plan, own, self._ledger)
            for one, own in zip(requirements, moves, strict=True)
        ]
        asked = frozenset[int]().union(*(rule.nodes for rule in self._rules))
        self._timeline = Timeline(plan, names, asked)
        self._health = HealthLog()
        self._inputs = Inputs(compiled.checked, names)
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
            piece = {name: column[start : start + CHUNK] for name, column in columns.items()}
            self._health.count_columns(own, piece)
            made = self._timeline.take(own, piece)
            for rule in self._rules:
                rule.take(made, int(own[-1]))
            self._last = int(own[-1])
        if self._health.began is None and len(times):
            self._health.began = int(times[0])
            for slot in self._inputs.slots.values():
                slot.first_at = self._health.began

    @property
    def began(self) -> bool:
        """Whether there was a row."""
        return self._last is not None

    def report(self, until: int | None) -> Report:
        """End the trace and judge it; there has been a row.

        Args:
            until: its end in ticks, if after the last row.

        Raises:
            NotByColumnsError: what the input left open has to be told sample by sample.
        """
        last = self._last or 0
        end = last if until is None else max(last, until)
        piece = self._timeline.last_piece(end)
        for rule in self._rules:
            rule.take(piece, end)
            stands_at = last if piece.axis.start == piece.axis.stop else piece.axis.stop - 1
            rule.finish(self._timeline, end, stands_at)
        attempts, found = _assembled(self._rules, self._ledger.flush())
        return Report(
            verdicts={
                name: fold(verdict for verdict, n in counts.items() if n)
                for name, counts in found.items()
            },
            attempts=attempts,
            counts={
                name: {verdict: counts[verdict] for verdict in _ATTEMPT_VERDICTS}
                for name, counts in found.items()
            },
            health=tuple(self._health.report(self._requirements, self._inputs, None)),
            origin=self._health.began or 0,
            end=end,
        )


def columns_judge(
    compiled: CompiledSpec, only: Sequence[str] | None, names: frozenset[str]
) -> ColumnJudge | None:
    """What judges requirements by columns; `None` if they have to be judged sample by sample.

    It takes automata of one clock at most, in held time and where samples are the positions; not
    what asks for the updates before the last, for payloads or captured values, or for the end.

    Args:
        compiled: the specification.
        only: ids of the requirements; default all.
        names: of the columns.
    """
    spec = compiled.checked
    chosen = [one for name, one in compiled.requirements.items() if only is None or name in only]
    if spec.max_delay is not None or not all(map(can_generate, chosen)):
        return None
    plan = plan_requirements(compiled, chosen)
    if plan.gap not in (None, 1):
        return None
    if any(spec.signals[name].stale_after is not None for name in names & spec.signals.keys()):
        return None
    leaves = [state.leaf for state in plan.graph.nodes if state.leaf is not None]
    if any(use.history for use in plan.uses.values()) or any(map(_looks_deeper, leaves)):
        return None
    moves = []
    for one in chosen:
        own = None if one.automaton is None else moves_of(one.automaton, plan.gap)
        if own is None or one.obligation.trigger is None or len(one.leaves) > _MOST_LEAVES:
            return None
        moves.append(own)
    return ColumnJudge(compiled, chosen, plan, moves, names)


def _looks_deeper(leaf: Leaf) -> bool:
    """Whether a leaf reads the fields of events."""
    return (isinstance(leaf, Compare) and bool(events_of(leaf.left, leaf.right))) or (
        isinstance(leaf, ProbeAtom) and leaf.probe is Probe.CHANGED
    )


def evaluate_columns(
    compiled: CompiledSpec,
    names: frozenset[str],
    blocks: Iterable[tuple[NDArray[np.int64], Columns]],
    *,
    only: Sequence[str] | None,
    until: int | None,
) -> Report | None:
    """Judge columns; `None` if they have to be judged sample by sample, or there are no rows.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: instants (int64[n] ticks, strictly increasing throughout) and the columns by name,
            of equal length: every signal is updated in each row. Not all are taken where the answer
            is `None`.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last row.
    """
    judge = columns_judge(compiled, only, names)
    if judge is None:
        return None
    try:
        for times, columns in blocks:
            judge.take(times, columns)
        return judge.report(until) if judge.began else None
    except NotByColumnsError:
        return None


def _assembled(
    rules: Sequence[ColumnRule], kept: Sequence[Attempt]
) -> tuple[JudgedAttempts, Mapping[str, Counter[Verdict]]]:
    """All attempts in the order of reports, and the count of their verdicts by requirement."""
    parts = [rule.decided() for rule in rules]
    rank = {rule.compiled.requirement.id: index for index, rule in enumerate(rules)}
    counts = {name: Counter[Verdict]() for name in rank}
    for name, part in zip(rank, parts, strict=True):
        passed = int(np.count_nonzero(part.decisions.passed))
        counts[name][Verdict.PASS] = passed
        counts[name][Verdict.FAIL] = len(part) - passed
    for attempt in kept:
        counts[attempt.requirement][attempt.verdict] += 1
    others = [
        (FAR if one.decided is None else one.decided, rank[one.requirement], one.number)
        for one in kept
    ]
    return JudgedAttempts(parts, kept, _order(parts, others)), counts


def _order(
    parts: Sequence[DecidedAttempts], others: Sequence[tuple[int, int, int]]
) -> NDArray[np.int64]:
    """The numbers of attempts by instant of decision, requirement and number."""
    keys = np.array(others, np.int64).reshape(-1, 3)
    decided = np.concatenate([*(part.decisions.decided for part in parts), keys[:, 0]])
    number = np.concatenate([*(part.decisions.number for part in parts), keys[:, 2]])
    if len(parts) == 1 and bool((decided[1:] > decided[:-1]).all()):
        return np.arange(len(decided))
    ranks = np.concatenate([*(np.full(len(part), i) for i, part in enumerate(parts)), keys[:, 1]])
    return np.lexsort((number, ranks, decided))
