"""A run of the core that is put away and taken up again at each call, beside one that is not."""

from dataclasses import fields
from typing import Any

from tests.tools.drive import Found, Lost, told

from rvmon import native
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import report_of_run
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample
from rvmon.verdicts.attempt import Attempt

HEAD = 32
"""Bytes of the head of a snapshot; the last eight are the hash of what follows."""


class Twins:
    """Two runs that are told the same; all that they say has to be alike."""

    def __init__(self, planned: PlannedCore, absent: frozenset[str]) -> None:
        self._planned = planned
        self.plain: native.Monitor = planned.monitor(absent)
        self.other: native.Monitor = planned.monitor(absent)
        self.taken = 0

    def tell(self, action: Sample | int | Lost | Found) -> None:
        """Tell both, and take one up again from what it is put away as."""
        said = [tell(self._planned, one, action) for one in (self.plain, self.other)]
        assert said[0] == said[1], f"at {action}: {said}"
        self.take_up()

    def take_up(self) -> None:
        """Have one run be taken up again by a monitor that was just made."""
        data = self.other.save()
        made = self._planned.monitor(frozenset())
        assert made.load(data), "what it was put away as is refused"
        assert made.save() == data, "it is put away as something else the second time"
        self.other = made
        self.taken += 1
        assert _state(self.plain) == _state(self.other)
        *_, letters = self.other.records()
        if not letters:  # else each of both may share others of them between notes
            assert self.plain.save() == self.other.save(), "it does not stand as before"

    def finish(self, end: int | None) -> None:
        """End both."""
        assert self.plain.finish(end) == self.other.finish(end)
        assert self.plain.flush() == self.other.flush()
        self.take_up()
        assert _of_records(self._planned, self.plain) == _of_records(self._planned, self.other)


def tell(planned: PlannedCore, run: native.Monitor, action: Sample | int | Lost | Found) -> Any:
    """Tell a run something; what it says."""
    match action:
        case Lost(names, t):
            return run.lose([planned.numbers[name] for name in names], t), run.flush()
        case Found(names, t):
            return run.found([planned.numbers[name] for name in names], t), run.flush()
        case Sample(t, values):
            return run.judge(t, planned.plain(t, values), True), run.flush()
        case _:
            run.advance(action)
            return run.flush()


def _state(run: native.Monitor) -> Any:
    return run.next_due(), run.open(), run.counts(), run.times()


def _of_records(planned: PlannedCore, run: native.Monitor) -> list[dict[str, Any]]:
    """All that is said of attempts, reasons among it."""
    attempts = report_of_run(planned, run, 0, None).attempts
    return [{one.name: getattr(it, one.name) for one in fields(Attempt)} for it in attempts]


def put_away(compiled: CompiledSpec, case: Case) -> int:
    """Run a case twice, once taken up again behind each call; how often it was."""
    names = frozenset((*compiled.checked.signals, *compiled.checked.events))
    absent = frozenset() if case.names is None else names - case.names
    twins = Twins(planned_core(compiled), absent)
    twins.take_up()
    for action in told(case):
        twins.tell(action)
    twins.finish(case.end)
    return twins.taken
