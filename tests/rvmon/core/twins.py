"""Checks that a run of the core behaves the same when it is saved and loaded after each call."""

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
"""Bytes of the header of a snapshot; the last eight are the hash of the body."""


class Twins:
    """Two runs with the same input, of which one is saved and loaded; their outputs must agree."""

    def __init__(self, planned: PlannedCore, absent: frozenset[str] = frozenset()) -> None:
        self._planned = planned
        self.plain: native.Monitor = planned.monitor(absent)
        self.other: native.Monitor = planned.monitor(absent)
        self.reloads = 0

    def tell(self, action: Sample | int | Lost | Found) -> None:
        """Give both an action, then save and load one of them."""
        said = [tell(self._planned, one, action) for one in (self.plain, self.other)]
        assert said[0] == said[1], f"at {action}: {said}"
        self.reload()

    def reload(self) -> None:
        """Load the snapshot of one run into a new monitor, which replaces it."""
        data = self.other.save()
        made = self._planned.monitor(frozenset())
        assert made.load(data), "the snapshot is refused"
        assert made.save() == data, "the loaded run has another snapshot"
        self.other = made
        self.reloads += 1
        assert _state(self.plain) == _state(self.other)
        *_, letters = self.other.records()
        if not letters:  # notes share letters, and the two runs may share different ones
            assert self.plain.save() == self.other.save(), "the runs have different states"

    def finish(self, end: int | None) -> None:
        assert self.plain.finish(end) == self.other.finish(end)
        assert self.plain.flush() == self.other.flush()
        self.reload()
        assert _of_records(self._planned, self.plain) == _of_records(self._planned, self.other)


def tell(planned: PlannedCore, run: native.Monitor, action: Sample | int | Lost | Found) -> Any:
    """Give a run an action; returns its answer."""
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
    """All fields of all attempts, including their reasons."""
    attempts = report_of_run(planned, run, 0, None).attempts
    return [{one.name: getattr(it, one.name) for one in fields(Attempt)} for it in attempts]


def reload_after_each_call(compiled: CompiledSpec, case: Case) -> int:
    """Judge a case plainly and with a reload after each call; returns the number of reloads."""
    names = frozenset((*compiled.checked.signals, *compiled.checked.events))
    absent = frozenset() if case.names is None else names - case.names
    twins = Twins(planned_core(compiled), absent)
    twins.reload()
    for action in told(case):
        twins.tell(action)
    twins.finish(case.end)
    return twins.reloads
