"""Online monitors that are compiled C; their records have no reasons."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_exact import too_large
from rvmon.codegen.c_online import NEVER, NOT_YET, OnlineLibrary, online_library
from rvmon.codegen.c_tables import VERDICTS
from rvmon.errors import SnapshotError
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.monitor import Monitor
from rvmon.trace.sample import Payload, Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold


class CompiledMonitor(Monitor):
    """A monitor whose `step_ns` is compiled C.

    Samples that need a closer look (other than plain values in a `dict`, what is wrong) take the
    way of every monitor up to the judging.

    Args:
        library: compiled for the requirements.
        compiled: the specification.
        requirements: to be judged.
        settle: see `build_monitor`.
        sources: the names that can arrive; `None`: all.
    """

    def __init__(
        self,
        library: OnlineLibrary,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        settle: str,
        sources: frozenset[str] | None,
    ) -> None:
        names = {*compiled.checked.signals, *compiled.checked.events}
        absent = frozenset() if sources is None else frozenset(names - sources)
        self._library = library
        self._ids = [one.requirement.id for one in requirements]
        self._core = library.core(
            absent,
            look_closer=self._take_at,
            look_closer_ns=self._look_closer,
        )
        super().__init__(compiled, requirements, "c", settle, sources, None)

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
        """Have C take no samples, and note how far the run has come."""
        self._core.hold(True)
        self._note_times()

    def _leave(self) -> None:
        self._core.hold(False)

    def _note_times(self) -> None:
        sampled, began, last, reached = self._core.times()
        self._health.began = began if sampled else None
        self._last = None if last == NOT_YET else last
        self._reached = None if reached == NOT_YET else reached

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
        # C takes `str` alone, no subclasses of it, such as members of an enumeration.
        self._core.take(
            t, {str.__str__(name): self._plain(name, value, t) for name, value in values.items()}
        )

    def _plain(self, name: str, value: Value, t: int) -> Value:
        """A value as C takes it.

        Raises:
            TraceError: a whole number is too large.
        """
        if isinstance(value, tuple):
            if len(value) > 1:
                return tuple(self._payload(name, payload, t) for payload in value)
            value = value[0] if value else False
        if isinstance(value, Mapping):
            return self._payload(name, value, t)
        self._expect_exact(name, value, t)
        return value

    def _payload(self, name: str, payload: Payload, t: int) -> Payload:
        for field, scalar in payload.items():
            self._expect_exact(f"{name}.{field}", scalar, t)
        return {str.__str__(field): scalar for field, scalar in payload.items()}

    def _expect_exact(self, name: str, value: object, t: int) -> None:
        limit = self._library.limits.get(name)
        if limit is not None and isinstance(value, int) and abs(value) > limit:
            raise too_large(name, value, limit, t)

    def _flush(self) -> Sequence[Attempt]:
        return self._core.flush()

    def _pass_to(self, t: int) -> None:
        self._core.advance(t)

    def _verdicts_so_far(self) -> Mapping[str, Verdict]:
        so_far = (Verdict.FAIL, Verdict.PASS)
        return {
            name: fold(verdict for verdict in so_far if own[VERDICTS.index(verdict)])
            for name, own in zip(self._ids, self._core.counts(), strict=True)
        }

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        import numpy as np

        from rvmon.codegen.c_batch import RunRecords, record_type
        from rvmon.monitor.c.recorded import report_of_records

        end = self._core.close(t_ns)
        decided = self._core.flush()
        self._note_times()
        made = RunRecords(
            np.frombuffer(self._core.records(), record_type(self._library.plan)),
            ordered=False,
            counts=np.array(self._core.counts(), np.int64).reshape(-1, 4),
            end=None if end == NOT_YET else end,
        )
        captured = CapturedValues(self._library.plan)
        origin = self._health.began or 0
        return report_of_records(self._ids, made, captured, origin=origin), decided

    def snapshot(self) -> bytes:
        """Refused: what C holds cannot be checked when it comes back.

        Raises:
            SnapshotError: always.
        """
        raise SnapshotError(
            "a compiled monitor cannot be put away: use the engine `auto` for snapshots"
        )

    def _owed(self, most: int | None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        """See `Monitor.owed`; without deadlines and forecasts."""
        found = [] if self._report is not None else self._core.open()
        return Counter(one.requirement for one in found), found[:most]

    def _next_due(self) -> int | None:
        if self._reached is None or self._report is not None:
            return None
        found = self._core.next_due()
        return max(found, self._reached + 1) if found < NEVER else None


def compiled_monitor(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    settle: str,
    sources: frozenset[str] | None,
) -> CompiledMonitor:
    """A monitor that is compiled C; compiled once for a specification.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        settle: see `build_monitor`.
        sources: the names that can arrive; `None`: all.

    Raises:
        RvmonError: there is no C compiler, or a requirement is beyond generated code.
    """
    ids = tuple(one.requirement.id for one in requirements)
    key = ("online c", ids)
    library = compiled.forms.get(key)
    if not isinstance(library, OnlineLibrary):
        library = compiled.forms[key] = online_library(plan_alone(compiled, ids))
    return CompiledMonitor(library, compiled, requirements, settle, sources)
