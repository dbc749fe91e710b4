"""Random runs that lose samples on input, and a check of their verdicts against the law.

An input ("door") is a pipe of lines, `Live` or `DurableMonitor`. Brokers and middleware report
their losses to the same driver and have tests of their own.
"""

import itertools
import json
import random
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from random import Random
from time import sleep
from typing import Any

from tests.tools.differential import cases_of
from tests.tools.law import judge, word
from tests.tools.sound import is_spoken_of, narrowed

from rvmon.adapters.json_objects import JsonObjects, feed_lines
from rvmon.errors import TraceError
from rvmon.live import Driver, DurableMonitor, Live, SimulatedClock
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict

FILLINGS = 6
"""How often the lost values are replaced, the first time by the true values."""

EACH = 4
"""Runs of a specification."""

GREEN = (Verdict.PASS, Verdict.NOT_TRIGGERED)
START = 1_000
"""Ticks added to all stamps, because no format has negative stamps."""

Verdicts = Mapping[str, Verdict]


@dataclass(slots=True)
class Trial:
    """A run with a stretch of samples to be lost at a door."""

    name: str  # seed of every draw
    spec: Spec
    case: Case  # the true run
    lost: range  # indices of the lost samples
    folder: Path  # for files
    rng: random.Random = field(init=False)  # draws how the samples are lost
    names: list[str] = field(init=False)  # names in the lost samples
    # set by a door if the samples came too late, so that a false alarm may remain
    is_late: bool = False
    is_named: bool = False  # set by a door that knows the names in each lost sample

    def __post_init__(self) -> None:
        self.rng = random.Random(f"{self.name} door")
        self.names = sorted({n for place in self.lost for n in self.case.samples[place].values})

    @property
    def end(self) -> int:
        """An instant after all samples."""
        return self.case.samples[-1].t + 1


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of a trial."""

    name: str  # of the trial
    # requirements with a verdict that some replacement of the lost values contradicts
    overturned: tuple[str, ...]
    is_split: bool  # whether verdicts depend on the lost values


Door = Callable[[Trial], Verdicts]
"""An input that loses samples of a trial and returns verdicts."""


def trials(door: str, seed: object, folder: Path) -> Iterator[Trial]:
    """Endless trials whose loss changes a letter that a requirement reads."""
    traces = TraceProfile(advances=False)
    for number in itertools.count():
        spec = None
        drawn = cases_of(f"{door}/{seed}/{number}", Profile(), traces, EACH)
        for part, case in enumerate(map(_plain, drawn)):
            spec = spec or Spec(case.spec)
            if len(case.samples) < 3 or case.spec.max_delay or not is_spoken_of(case.spec):
                continue
            name = f"{door}/{seed}/{number}/{part}"
            rng = random.Random(name)
            # The first and the last sample are kept: their loss might go unnoticed.
            begin = rng.randrange(1, len(case.samples) - 1)
            lost = range(begin, min(begin + rng.randint(1, 6), len(case.samples) - 1))
            trial = Trial(name, spec, case, lost, folder / f"{number}.{part}")
            if trial.names and _changes_a_letter(trial):
                trial.folder.mkdir()
                yield trial


def _plain(case: Case) -> Case:
    """A case with later stamps, without empty samples and reports that an event did not occur."""
    signals = case.spec.signals
    samples = [
        Sample(START + t, {n: v for n, v in values.items() if n in signals or v is not False})
        for t, values in ((sample.t, sample.values) for sample in case.samples)
    ]
    return replace(case, actions=tuple(sample for sample in samples if sample.values), end=None)


def _changes_a_letter(trial: Trial) -> bool:
    rest = [s for place, s in enumerate(trial.case.samples) if place not in trial.lost]
    truly, without = (
        word(narrowed(replace(trial.case, actions=(*actions, trial.end))))
        for actions in (trial.case.samples, rest)
    )
    return repr(truly.letters) != repr(without.letters)


def outcome(trial: Trial, verdicts: Verdicts) -> Outcome:
    """Compare the verdicts of a door with the law for several replacements of the lost values."""
    rng = random.Random(f"{trial.name} fillings")
    case = narrowed(trial.case)
    seen: dict[str, set[bool]] = {name: set() for name in case.spec.requirements}
    bad = set()
    for which in range(FILLINGS):
        filled = case if which == 0 else _filled(rng, trial, case)
        truly = judge(replace(filled, actions=(*filled.actions, trial.end))).verdicts
        # A lost sample may have held the first value of a signal, so it is no excuse (section 1).
        born = all(_has_value(filled, trial, name) for name in trial.names)
        for name, verdict in verdicts.items():
            failed = truly[name] is Verdict.FAIL
            if verdict in GREEN and failed:
                bad.add(name)
            if verdict is Verdict.FAIL and not failed and not trial.is_late and born:
                bad.add(name)
        for name, verdict in truly.items():
            seen[name].add(verdict is Verdict.FAIL)
    split = any(len(kinds) > 1 for kinds in seen.values())
    return Outcome(trial.name, tuple(sorted(bad)), split)


def _has_value(case: Case, trial: Trial, name: str) -> bool:
    """Whether a name has had a value at the end of the loss; always true for events."""
    known = case.samples[: trial.lost.stop]
    values = (sample.values[name] for sample in known if name in sample.values)
    return name in case.spec.events or any(value is not None and value == value for value in values)


def _filled(rng: random.Random, trial: Trial, case: Case) -> Case:
    """The case of a trial with random values in place of the lost ones."""
    samples = list(case.samples)
    names = {*trial.names}
    others: Any = random_trace(rng, case.spec, TraceProfile()).samples or samples
    for place in trial.lost:
        true = samples[place].values
        kept = {n: v for n, v in true.items() if n not in names}
        replaced = names & true.keys() if trial.is_named else names
        values = {n: v for n, v in rng.choice(others).values.items() if n in replaced}
        samples[place] = Sample(samples[place].t, kept | values)
    return replace(case, actions=tuple(samples))


def outcomes(name: str, door: Door, count: int, seed: object, folder: Path) -> Iterator[Outcome]:
    """The results of `count` trials at a door."""
    for trial in islice(trials(name, seed, folder), count):
        yield outcome(trial, door(trial))
        shutil.rmtree(trial.folder)


def _object_of(sample: Sample) -> bytes:
    """A sample as a JSON object."""
    values = {n: [*v] if isinstance(v, tuple) else v for n, v in sample.values.items()}
    return json.dumps({"t_ns": sample.t, **values}).encode()


def _damaged(rng: Random, line: bytes) -> bytes:
    """A line with unknowable content: cut, or replaced by something unusable."""
    half = line[: rng.randrange(1, len(line) - 1)]
    large = line.replace(b": ", b': 1e400, "t_ns": ', 1)
    return rng.choice([half, line[:-1] + b',"q":1,"q":1}', large, b"\xff", b"[]", b'"on"'])


def _closed(driver: Driver, clock: SimulatedClock, trial: Trial) -> Verdicts:
    """The verdicts one tick after the last sample."""
    clock.set_ns(max(clock.now_ns(), trial.end))
    return driver.close()[""][-1].verdicts


def _stdin(trial: Trial) -> Verdicts:
    """Lines that are damaged, late, or missing but for the start of the first."""
    rng, clock = trial.rng, SimulatedClock(trial.case.samples[0].t)
    driver = Driver(trial.spec, clock=clock, sources=trial.case.names)
    lines = [_object_of(sample) for sample in trial.case.samples]
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
    """A source that is down, or samples that are late, too many or refused."""
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
            if not is_heard_at_once:  # the loss is noticed only at its end
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
    """The lost samples arrive while the callback of another sample is running."""
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
    """A run that is killed repeatedly and whose lost samples are missed, refused or late."""
    rng = trial.rng
    told: dict[int, object] = {}

    def tell(number: int, attempt: object) -> None:
        if told.setdefault(number, attempt) != attempt:
            raise AssertionError(f"{number} was reported twice with a difference")

    def started() -> DurableMonitor:
        path = trial.folder / "run"
        if rng.random() < 0.3 and path.exists():  # killed while writing an entry
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
    monitor = started()
    for place, sample in enumerate(trial.case.samples):
        if rng.random() < 0.3:
            monitor = started()
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
                monitor = started()
    monitor.advance_ns(trial.end)
    if rng.random() < 0.3:
        monitor = started()
    return monitor.monitor.finish_ns().verdicts


def _refuse(monitor: DurableMonitor, t: int, values: dict[str, Any]) -> None:
    try:
        monitor.step_ns(t, values)
    except TraceError:
        return
    raise AssertionError("the sample was not refused")


DOORS: Mapping[str, Door] = {"stdin": _stdin, "live": _live, "durable": _durable}
