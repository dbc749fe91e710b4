"""Online monitors that the core runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from heapq import nsmallest
from typing import Any

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.planned import VERDICTS, PlannedCore
from rvmon.monitor.core.snapshot import put_back, written
from rvmon.monitor.inputs.health import by_name, of_intake
from rvmon.monitor.inputs.validate import Validator
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.monitor import Monitor
from rvmon.monitor.online.one_call import overlap
from rvmon.trace.sample import Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold


class CoreMonitor(Monitor):
    """A monitor whose `step_ns` is a function of the core.

    Samples that need a closer look (other than plain values in a `dict`, what is wrong) take the
    way of every monitor up to the judging.

    Args:
        planned: the plan of the requirements.
        compiled: the specification.
        settle: see `build_monitor`.
        sources: the names that can arrive; `None`: all.
        keep: so many records of each verdict are kept per requirement; `None`: all.
    """

    STATE = ("_intake", "_torn")

    def __init__(
        self,
        planned: PlannedCore,
        compiled: CompiledSpec,
        settle: str,
        sources: frozenset[str] | None,
        keep: int | None,
    ) -> None:
        names = frozenset((*compiled.checked.signals, *compiled.checked.events))
        self._planned = planned
        self._core = planned.monitor(
            names - (names if sources is None else sources), self._take_at, self._look_closer
        )
        if keep is not None:
            self._core.keep(keep)
        super().__init__(compiled, (), "c", settle, sources, None)
        self._validator = Validator(compiled.checked, sources, planned.single_payloads)

    def _attend(self) -> None:
        if self._intake is None and not self._listeners:
            self.step, self.step_ns = self._core.step, self._core.step_ns
        else:
            self.step, self.step_ns = self._take_at, self._take

    def _make_evaluators(self) -> Evaluators:
        return Evaluators(
            self.options.compiled.checked, (), "auto", self.options.sources, self._ledger
        )

    def _begin(self) -> None:
        super()._begin()
        self._core.reset()

    def _enter(self) -> None:
        """Have the core take no samples quickly, and note how far the run has come."""
        if not self._core.hold(True):
            raise overlap()
        self._note_times()

    def _leave(self) -> None:
        self._core.hold(False)

    def _note_times(self) -> None:
        self._health.began, self._last, self._reached = self._core.times()

    def _take(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """See `Monitor`."""
        if self._intake is not None:
            return super()._take(t_ns, values)
        decided = self._core.step_ns(t_ns, values)
        self._listeners.call(decided)
        return decided

    def _look_closer(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample by the way of every monitor; who asked for that reports what it decides."""
        return self.one_call(self._step, t_ns, values)

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if not self._core.judge(t, self._planned.plain(t, values), True):
            raise ValueError("the core does not take a sample that was checked")

    def _flush(self) -> Sequence[Attempt]:
        return self._core.flush()

    def _pass_to(self, t: int) -> None:
        self._core.advance(t)

    def _verdicts_so_far(self) -> Mapping[str, Verdict]:
        so_far = (Verdict.FAIL, Verdict.PASS)
        return {
            name: fold(verdict for verdict in so_far if own[VERDICTS.index(verdict)])
            for name, own in zip(self._planned.packed.ids, self._core.counts(), strict=True)
        }

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        from rvmon.monitor.core.recorded import report_of_run

        end = self._core.finish(t_ns)
        decided = self._core.flush()
        self._note_times()
        report = report_of_run(self._planned, self._core, self._health.began or 0, end)
        health = [] if self._intake is None else of_intake(self._intake)
        return replace(report, health=tuple(sorted(health, key=by_name))), decided

    def _written(self) -> bytes:
        return written(self.options, self._planned, self._core, self)

    def take_up(self, document: Mapping[str, Any]) -> None:
        """See `Monitor.take_up`."""
        put_back(document, self._planned, self._core, self)
        self._note_times()

    def _owed(self, most: int | None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        """See `Monitor.owed`."""
        found = [] if self._report is not None else self._core.open()
        if most is None:
            return Counter(one.requirement for one in found), found
        oldest: dict[object, Attempt] = {}
        for one in found:
            each = self._planned.instance(one)
            if each not in oldest or one.triggered < oldest[each].triggered:
                oldest[each] = one
        chosen = nsmallest(most, oldest.values(), key=lambda one: one.triggered)
        return Counter(one.requirement for one in found), chosen

    def _next_due(self) -> int | None:
        if self._reached is None or self._report is not None:
            return None
        found = self._core.next_due()
        return None if found is None else max(found, self._reached + 1)
