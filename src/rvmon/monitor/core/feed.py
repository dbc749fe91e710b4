"""What a run of the core is fed: samples in order of time, and what was lost between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rvmon import native
from rvmon.errors import SnapshotError
from rvmon.monitor.core.losses import Losses
from rvmon.monitor.core.planned import PlannedCore
from rvmon.monitor.inputs.health import of_intake
from rvmon.monitor.inputs.intake import Intake, Turn, refuse_earlier
from rvmon.monitor.inputs.validate import Validator
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import Health
from rvmon.trace.sample import Sample, Value


class Feed:
    """Checks samples, holds back those that cannot be judged yet, and has the core judge them.

    Args:
        checked: the specification.
        planned: the plan of its requirements.
        core: the run.
        sources: the names that can arrive; `None`: all.
        settle: one of `rvmon.monitor.inputs.intake.WAYS_TO_SETTLE`.

    Attributes:
        losses: what is lost.
    """

    def __init__(
        self,
        checked: CheckedSpec,
        planned: PlannedCore,
        core: native.Monitor,
        sources: frozenset[str] | None,
        settle: str,
    ) -> None:
        delay = checked.max_delay or 0
        self._intake = Intake(delay, checked.events) if delay or settle == "next" else None
        self.losses = Losses(checked, planned, core, self._intake)
        self._planned = planned
        self._core = core
        self.check = Validator(checked, sources, planned.single_payloads).check

    @property
    def is_direct(self) -> bool:
        """Whether the core may take the next sample itself, as there is no more to do with it."""
        return self._intake is None and not self.losses.awaits_sample

    def is_too_late(self, t: int) -> bool:
        """Whether a sample at an instant comes later than it may be late."""
        return self._intake is not None and self._intake.is_too_late(t)

    def take(self, t: int, values: Mapping[str, Value]) -> None:
        """Take a sample, at ticks.

        Args:
            t: its instant.
            values: from `check`.

        Raises:
            TimeOrderError: it comes behind what was judged; nothing changed.
        """
        if self._intake is None:
            _, last, reached = self._core.times()
            refuse_earlier(t, last, reached)
        if self.losses.awaits_sample:
            self._turn(self.losses.end_missed(t))
        if self._intake is None:
            self._judge(t, values)
        else:
            self._judge_all(self._intake.take(t, values))
            self._core.advance(self._intake.floor)

    def advance(self, t: int) -> None:
        """Learn that no sample before an instant will come."""
        if self._intake is not None:
            self._judge_all(self._intake.settle(t))
        self._core.advance(t)

    def close(self) -> None:
        """Learn that no sample will come."""
        if self._intake is not None:
            self._judge_all(self._intake.close())

    def lose(self, names: Iterable[str] | None, since: int, until: int | None, why: str) -> None:
        """Have names lost; see `rvmon.monitor.core.fed.FedMonitor.lose_ns`."""
        self._turn(self.losses.lose(names, since, until, why))

    def find(self, names: Iterable[str] | None, at: int) -> None:
        """Have them lost no more behind an instant."""
        self._turn(self.losses.find(names, at))

    def miss(self, names: Iterable[str] | None, why: str) -> None:
        """Have them lost between the last sample and the next."""
        _, last, _ = self._core.times()
        since = last if self._intake is None else self._intake.newest
        self._turn(self.losses.miss(names, since, why))

    def _turn(self, turns: Sequence[Turn]) -> None:
        """Have names lost or found now, or when what is held back is judged so far."""
        if self._intake is None:
            self._judge_all(turns)
        else:
            self._intake.turn(turns)

    def _judge_all(self, settled: Sequence[Sample | Turn]) -> None:
        for one in settled:
            if isinstance(one, Turn):
                self.losses.turn(one)
            else:
                self._judge(one.t, one.values)

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if not self._core.judge(t, self._planned.plain(t, values), True):
            raise ValueError("the core does not take a sample that was checked")

    def health(self) -> list[Health]:
        """What was found of samples on their way, and what was lost."""
        held = [] if self._intake is None else of_intake(self._intake)
        return [*held, *self.losses.health()]

    def state(self) -> Mapping[str, Any]:
        """What is held back and lost, as JSON has it."""
        held = None if self._intake is None else self._intake.state()
        return {"intake": held, "losses": self.losses.state()}

    def take_up(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state` gave.

        Raises:
            SnapshotError: it fits no such run.
        """
        intake = state["intake"]
        if (intake is None) != (self._intake is None):
            raise SnapshotError("the snapshot is damaged: it holds samples back that nobody awaits")
        if self._intake is not None:
            self._intake.take_up(intake, self.check, self.losses.known)
        self.losses.take_up(state["losses"])
