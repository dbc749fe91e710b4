"""Doors at which something of a run is lost: a pipe of lines, `Live`, `DurableMonitor`.

What files refuse, and how brokers and middleware notice what they lose, their tests show;
all of them tell the same driver.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from random import Random
from time import sleep
from typing import Any

from rvmon.adapters.json_objects import JsonObjects, feed_lines
from rvmon.errors import TraceError
from rvmon.live import Driver, DurableMonitor, Live, SimulatedClock
from rvmon.trace.sample import Sample
from tests.tools.lost import Door, Trial, Verdicts


def _object_of(sample: Sample) -> bytes:
    """A sample as JSON has it."""
    values = {n: [*v] if isinstance(v, tuple) else v for n, v in sample.values.items()}
    return json.dumps({"t_ns": sample.t, **values}).encode()


def _damaged(rng: Random, line: bytes) -> bytes:
    """A line, or object, of which nobody can say what it held."""
    half = line[: rng.randrange(1, len(line) - 1)]
    large = line.replace(b": ", b': 1e400, "t_ns": ', 1)
    return rng.choice([half, line[:-1] + b',"q":1,"q":1}', large, b"\xff", b"[]", b'"on"'])


def _closed(driver: Driver, clock: SimulatedClock, trial: Trial) -> Verdicts:
    """The verdicts when all was offered, and a tick is over."""
    clock.set_ns(max(clock.now_ns(), trial.end))
    return driver.close()[""][-1].verdicts


def _stdin(trial: Trial) -> Verdicts:
    """Lines that are damaged, come late, or are cut from inside of one to inside of another."""
    rng, clock = trial.rng, SimulatedClock(trial.case.samples[0].t)
    driver = Driver(trial.spec, clock=clock, sources=trial.case.names)
    lines = [_object_of(one) for one in trial.case.samples]
    lost = [lines[place] for place in trial.lost]
    kept = [line for place, line in enumerate(lines) if place not in trial.lost]
    place = trial.lost.start
    match rng.choice(("damaged", "late", "cut")):
        case "damaged":
            kept[place:place] = [_damaged(rng, line) for line in lost]
        case "late":
            trial.is_late = trial.is_named = True
            place = rng.randrange(place + 1, len(kept) + 1)
            kept[place:place] = lost
        case _:
            kept.insert(place, lost[0][: rng.randrange(1, len(lost[0]) - 1)])
    feed_lines(JsonObjects(driver, clock=clock), kept)
    return _closed(driver, clock, trial)


def _live(trial: Trial) -> Verdicts:
    """A source that is down, samples that come late, are too many, or are refused."""
    how = trial.rng.choice((_down, _late, _flood, _refused))
    clock = SimulatedClock(trial.case.samples[0].t)
    with Live(trial.spec, clock=clock, sources=trial.case.names) as driver:
        how(trial, driver, clock)
        return _closed(driver, clock, trial)


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


def _durable(trial: Trial) -> Verdicts:
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


DOORS: Mapping[str, Door] = {"stdin": _stdin, "live": _live, "durable": _durable}
"""By name."""
