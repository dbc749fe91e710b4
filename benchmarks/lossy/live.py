"""A pipe of lines, `Live` and `DurableMonitor`, as they lose samples."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import wraps
from random import Random
from threading import Thread
from time import sleep
from typing import Any

from benchmarks.lossy.trial import Trial, Verdicts

from rvmon.adapters.json_objects import JsonObjects, feed_lines, read_lines
from rvmon.errors import TraceError
from rvmon.live import Driver, DurableMonitor, Live, SimulatedClock
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind


def one_by_one(
    through: Callable[[Trial], Verdicts | None],
) -> Callable[[Iterator[Trial]], Iterator[Verdicts | None]]:
    """What loses something of one run, for several."""

    @wraps(through)
    def all_of_them(trials: Iterator[Trial]) -> Iterator[Verdicts | None]:
        return map(through, trials)

    return all_of_them


def object_of(sample: Sample, *, stamped: bool = True) -> bytes:
    """A sample as JSON has it."""
    values = {n: [*v] if isinstance(v, tuple) else v for n, v in sample.values.items()}
    return json.dumps({"t_ns": sample.t, **values} if stamped else values).encode()


def damaged(rng: Random, line: bytes) -> bytes:
    """A line, or object, of which nobody can say what it held."""
    half = line[: rng.randrange(1, len(line) - 1)]
    large = line.replace(b": ", b': 1e400, "t_ns": ', 1)
    return rng.choice([half, line[:-1] + b',"q":1,"q":1}', large, b"\xff", b"[]", b'"on"'])


def closed(driver: Driver, clock: SimulatedClock, trial: Trial) -> Verdicts:
    """The verdicts when all was offered, and a tick is over."""
    clock.set_ns(max(clock.now_ns(), trial.end))
    return driver.close()[""][-1].verdicts


class Heard:
    """One run that is heard; its driver works when it is told to."""

    def __init__(self, trial: Trial, reading: Any = None) -> None:
        self.trial, self.samples = trial, trial.case.samples
        self.clock = SimulatedClock(self.samples[0].t)
        self.driver = Driver(reading or trial.spec, clock=self.clock, sources=trial.case.names)

    def flood(self, place: int) -> None:
        """Have a sample come where there is no room."""
        self.driver._waiting.room = 0
        self.driver.offer(self.samples[place].values, t_ns=self.samples[place].t)
        self.driver._waiting.room = 10_000

    def verdicts(self) -> Verdicts:
        """Those of the end."""
        return closed(self.driver, self.clock, self.trial)


class Topics(Heard):
    """One run of which each name is a topic of ROS, below a home."""

    def __init__(self, trial: Trial, home: str) -> None:
        self.topics = {
            n: f"{home}/{n}" for n in (*trial.case.spec.signals, *trial.case.spec.events)
        }
        self.reading = trial.spec.reading(columns=self.topics)
        super().__init__(trial, self.reading)

    def kind(self, name: str) -> str:
        """The type of std_msgs that carries a name."""
        signal = self.trial.case.spec.signals.get(name)
        return "Empty" if signal is None else _KINDS[signal.type.kind]

    def said(self, name: str, value: Any) -> Any:
        """A value, as the type of its topic has it."""
        return float(value) if self.kind(name) == "Float64" else value


_KINDS = {Kind.BOOL: "Bool", Kind.INT: "Int64", Kind.REAL: "Float64", Kind.LABEL: "String"}


@one_by_one
def stdin(trial: Trial) -> Verdicts:
    """Lines that are damaged, come late, or have lines of nobody between them, in pieces."""
    rng, run = trial.rng, Heard(trial)
    lines = [object_of(one) for one in run.samples]
    kept = [line for place, line in enumerate(lines) if place not in trial.lost]
    match rng.choice(("damaged", "late", "cut")):
        case "damaged":
            kept = [
                damaged(rng, one) if place in trial.lost else one for place, one in enumerate(lines)
            ]
        case "late":
            trial.is_late = trial.is_named = True
            kept.insert(
                rng.randrange(trial.lost.start + 1, len(kept) + 1), b"\n".join(_lost(trial, lines))
            )
        case _:  # from inside of one line to inside of another
            torn = b"\n".join(_lost(trial, lines))
            torn = torn[: rng.randrange(1, len(lines[trial.lost.start]) - 1)]
            kept.insert(trial.lost.start, torn)
    feed_lines(JsonObjects(run.driver, clock=run.clock), _piped(rng, kept))
    return run.verdicts()


def _lost(trial: Trial, lines: Sequence[bytes]) -> Sequence[bytes]:
    return [lines[place] for place in trial.lost]


def _piped(rng: Random, lines: Iterable[bytes]) -> Iterator[bytes]:
    """The same lines, as they come through a pipe in pieces of any size."""
    given, taken = os.pipe()
    text = b"".join(line + b"\n" for line in lines)

    def write() -> None:
        place = 0
        while place < len(text):
            place += os.write(taken, text[place : place + rng.randint(1, 99)])
        os.close(taken)

    writer = Thread(target=write)
    writer.start()
    try:
        yield from read_lines(given)
    finally:
        writer.join()
        os.close(given)


@one_by_one
def live(trial: Trial) -> Verdicts:
    """A source that is down, samples that come late, are too many, or are refused."""
    how = trial.rng.choice((_down, _late, _flood, _refused))
    clock = SimulatedClock(trial.case.samples[0].t)
    driver = Live(trial.spec, clock=clock, sources=trial.case.names)
    with driver:
        how(trial, driver, clock)
        return closed(driver, clock, trial)


def _come(driver: Driver, clock: SimulatedClock, sample: Sample) -> bool:
    clock.set_ns(max(sample.t, clock.now_ns()))
    return driver.offer(sample.values, t_ns=sample.t)


def _down(trial: Trial, driver: Driver, clock: SimulatedClock) -> None:
    names = trial.rng.choice((None, trial.names))
    is_heard_at_once = trial.rng.random() < 0.5
    trial.is_late = not is_heard_at_once
    since = None
    for place, sample in enumerate(trial.case.samples):
        clock.set_ns(sample.t)
        if place == trial.lost.start:
            since = sample.t
            if is_heard_at_once:
                driver.lose(names, robot="")
        if place not in trial.lost:
            driver.offer(sample.values, t_ns=sample.t)
        elif place == trial.lost[-1]:
            if not is_heard_at_once:  # what it meant for what was judged is told later
                driver.lose(names, robot="", since_ns=since)
            driver.found()
        if trial.rng.random() < 0.3:
            sleep(0.0005)


def _late(trial: Trial, driver: Driver, clock: SimulatedClock) -> None:
    trial.is_late = trial.is_named = True
    samples = trial.case.samples
    for sample in (s for place, s in enumerate(samples) if place not in trial.lost):
        _come(driver, clock, sample)
    for place in trial.lost:
        _come(driver, clock, samples[place])


def _flood(trial: Trial, driver: Driver, clock: SimulatedClock) -> None:
    """The lost samples come while the callback of another one takes its time."""
    trial.is_named = True
    with driver._working:
        driver._waiting.room = trial.lost.start + len(driver._waiting)
        for sample in trial.case.samples[: trial.lost.stop]:
            _come(driver, clock, sample)
    driver._waiting.room = 10_000
    while driver.waiting:
        sleep(0.0001)
    for sample in trial.case.samples[trial.lost.stop :]:
        _come(driver, clock, sample)


def _refused(trial: Trial, driver: Driver, clock: SimulatedClock) -> None:
    trial.is_named = True
    for place, sample in enumerate(trial.case.samples):
        wrong: dict[str, Any] = {"p": "on"} if "p" in sample.values else {"no such name": 1}
        values = {**sample.values, **wrong} if place in trial.lost else sample.values
        _come(driver, clock, Sample(sample.t, values))


@one_by_one
def durable(trial: Trial) -> Verdicts:
    """A run that is killed again and again, of which samples cannot be read or come too late."""
    rng = trial.rng
    told: dict[int, object] = {}

    def tell(number: int, attempt: object) -> None:
        if told.setdefault(number, attempt) != attempt:
            raise AssertionError(f"{number} was told twice, and otherwise")

    def begun() -> DurableMonitor:
        path = trial.folder / "run"
        if rng.random() < 0.3 and path.exists():  # in the midst of an entry
            with path.open("ab") as file:
                file.write(b'[5,{"p"')
        return DurableMonitor(
            *(trial.spec, path, tell),
            sources=trial.case.names,
            settle="next",
            every=rng.randint(1, 4),
        )

    how = rng.choice(("missed", "refused", "late"))
    trial.is_named = how != "missed"
    monitor = begun()
    for place, sample in enumerate(trial.case.samples):
        if rng.random() < 0.3:
            monitor = begun()
        if place not in trial.lost:
            monitor.step_ns(sample.t, dict(sample.values))
        elif how == "missed":
            monitor.miss(rng.choice((None, trial.names)))
        elif how == "refused":
            _refuse(monitor, sample.t, {**sample.values, "no such name": 1})
    if how == "late":
        trial.is_late = True
        for place in trial.lost:
            _refuse(monitor, trial.case.samples[place].t, dict(trial.case.samples[place].values))
            if rng.random() < 0.3:
                monitor = begun()
    monitor.advance_ns(trial.end)
    if rng.random() < 0.3:
        monitor = begun()
    return monitor.monitor.finish_ns().verdicts


def _refuse(monitor: DurableMonitor, t: int, values: dict[str, Any]) -> None:
    try:
        monitor.step_ns(t, values)
    except TraceError:
        return
    raise AssertionError("it was to be refused")
