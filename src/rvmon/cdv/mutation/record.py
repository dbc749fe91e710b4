"""Play tests and keep all that is recorded, so that runs can be held against each other."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.checker import Checker
from rvmon.cdv.code import Code
from rvmon.cdv.meter import Meter, statements_name
from rvmon.cdv.play import run_of
from rvmon.cdv.system import Observer, Run, System, Values
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Recorded:
    """A test that was played.

    Attributes:
        verdicts: by requirement.
        run: what the system reported at its end.
        samples: instants, and what changed or occurred.
        lines: of each file of the code under test, the statements that ran; where it was measured.
        cpu_s: processor time of this process that it took.
    """

    verdicts: Mapping[str, Verdict]
    run: Run
    samples: tuple[tuple[int, Values], ...]
    lines: Mapping[str, frozenset[int]]
    cpu_s: float


@dataclass(frozen=True, slots=True)
class Difference:
    """Where a run first differs from that of the code as it is.

    Attributes:
        test: that was played.
        t_ns: the instant; of a difference at the end of the run, that.
        name: the signal or event; `state`: of the robot; empty: the run's end itself.
        was: its value; empty: none.
        now: its value with the change; empty: none.
        verdicts: requirements that are judged otherwise, none of them F: verdicts before and after.
    """

    test: str
    t_ns: int
    name: str
    was: str
    now: str
    verdicts: tuple[tuple[str, str, str], ...] = ()


class Recorder:
    """Plays tests in this process.

    Args:
        system: that plays them.
        checker: that judges them.
        code: whose statements are measured; `None`: none.
    """

    def __init__(self, system: System[Test], checker: Checker, code: Code | None = None) -> None:
        self._system = system
        self._checker = checker
        self._code = code
        self._meter = None if code is None else Meter(code)

    def play(self, test: Test) -> Recorded:
        """Play a test; whatever its code raises is its result."""
        samples: list[tuple[int, Values]] = []
        self._checker.begin()
        if self._meter is not None:
            self._meter.begin()
        observer = Observer(
            (self._checker.observe, lambda t_ns, values: samples.append((t_ns, dict(values)))),
            code=self._meter,
        )
        begun = time.process_time()
        if self._meter is not None and self._code is not None and not self._code.marked:
            with self._meter:
                run = run_of(self._system, test, observer)
        else:
            run = run_of(self._system, test, observer)
        taken = time.process_time() - begun
        verdicts = self._checker.finish(run.end_ns).verdicts
        return Recorded(verdicts, run, tuple(samples), self._lines(), taken)

    def _lines(self) -> dict[str, frozenset[int]]:
        if self._meter is None or self._code is None:
            return {}
        hits = self._meter.hits()
        lines: dict[str, frozenset[int]] = {}
        for block in self._code.blocks:
            ran = frozenset(map(int, hits.get(statements_name(block.name), ())))
            lines[block.path] = lines.get(block.path, frozenset()) | ran
        return lines


def difference(test: str, was: Recorded, now: Recorded) -> Difference | None:
    """Where two runs of a test first differ in what is recorded; `None`: nowhere."""
    verdicts = tuple(
        (name, verdict.value, now.verdicts[name].value)
        for name, verdict in was.verdicts.items()
        if now.verdicts[name] is not verdict
    )
    places = [
        place
        for place in (
            _of_samples(was.samples, now.samples),
            _of_samples(_states(was), _states(now)),
            None if was.run.end_ns == now.run.end_ns else (now.run.end_ns, "", "", ""),
        )
        if place is not None
    ]
    if not places:
        return None
    return Difference(test, *min(places, key=lambda place: place[0]), verdicts)


def _states(one: Recorded) -> tuple[tuple[int, Values], ...]:
    return tuple((t_ns, {"state": state}) for t_ns, state in one.run.states)


def _of_samples(
    was: tuple[tuple[int, Values], ...], now: tuple[tuple[int, Values], ...]
) -> tuple[int, str, str, str] | None:
    for (t_was, values_was), (t_now, values_now) in zip(was, now, strict=False):
        if t_was < t_now:
            return _first(t_was, values_was, {})
        if t_now < t_was:
            return _first(t_now, {}, values_now)
        if found := _first(t_was, values_was, values_now):
            return found
    if len(was) > len(now):
        t_ns, values = was[len(now)]
        return _first(t_ns, values, {})
    if len(now) > len(was):
        t_ns, values = now[len(was)]
        return _first(t_ns, {}, values)
    return None


def _first(t_ns: int, was: Values, now: Values) -> tuple[int, str, str, str] | None:
    for name in {**was, **now}:
        before, after = _as_text(was, name), _as_text(now, name)
        if before != after:
            return t_ns, name, before, after
    return None


def _as_text(values: Values, name: str) -> str:
    """A value as text, all digits of it; NaN is as NaN."""
    if name not in values:
        return ""
    value = values[name]
    return "unknown" if value is None else str(value)
