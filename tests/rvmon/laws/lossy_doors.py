"""Random runs that lose something at a door: what are their verdicts worth then?

The doors are a pipe of lines, `Live` and `DurableMonitor`. What files refuse, and how brokers and
middleware notice what they lose, their tests show; all of them tell the same driver.
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
"""So many times what was lost is filled in: once by what it really was."""

EACH = 4
"""Runs of a specification."""

GREEN = (Verdict.PASS, Verdict.NOT_TRIGGERED)
START = 1_000
"""Ticks by which runs are later than they are drawn: no format has stamps below zero."""

Verdicts = Mapping[str, Verdict]


@dataclass(slots=True)
class Trial:
    """A run, and its samples that are to be lost at a door."""

    name: str  # of the run; every draw comes of it
    spec: Spec  # what judges
    case: Case  # the run as it truly was
    lost: range  # the places of the samples that are lost, which follow one another
    folder: Path  # for files
    rng: random.Random = field(init=False)  # draws how they are lost
    names: list[str] = field(init=False)  # what the lost samples spoke of
    # set by a door at which they came too late: a failure may stay that was none
    is_late: bool = False
    is_named: bool = False  # set by a door that knows of each lost sample what it spoke of

    def __post_init__(self) -> None:
        self.rng = random.Random(f"{self.name} door")
        self.names = sorted({n for place in self.lost for n in self.case.samples[place].values})

    @property
    def end(self) -> int:
        """An instant behind all samples."""
        return self.case.samples[-1].t + 1


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a trial."""

    name: str  # of the trial
    # the requirements whose verdict some filling turns that no filling may
    overturned: tuple[str, ...]
    is_split: bool  # whether fillings turn a verdict


Door = Callable[[Trial], Verdicts]
"""What loses something of a trial, and gives verdicts."""


def trials(door: str, seed: object, folder: Path) -> Iterator[Trial]:
    """Trials whose loss changes a letter that a requirement reads, without end."""
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
            # Of the first and the last nobody may know that there was one.
            begin = rng.randrange(1, len(case.samples) - 1)
            lost = range(begin, min(begin + rng.randint(1, 6), len(case.samples) - 1))
            trial = Trial(name, spec, case, lost, folder / f"{number}.{part}")
            if trial.names and _changes_a_letter(trial):
                trial.folder.mkdir()
                yield trial


def _plain(case: Case) -> Case:
    """The samples of a case, later, but for those that say nothing, or that events do not occur."""
    samples = [
        Sample(
            START + one.t,
            {n: v for n, v in one.values.items() if n in case.spec.signals or v is not False},
        )
        for one in case.samples
    ]
    return replace(case, actions=tuple(one for one in samples if one.values), end=None)


def _changes_a_letter(trial: Trial) -> bool:
    rest = [s for place, s in enumerate(trial.case.samples) if place not in trial.lost]
    truly, without = (
        word(narrowed(replace(trial.case, actions=(*actions, trial.end))))
        for actions in (trial.case.samples, rest)
    )
    return repr(truly.letters) != repr(without.letters)


def outcome(trial: Trial, verdicts: Verdicts) -> Outcome:
    """Hold the verdicts of a door against those of the law, however what was lost is filled in."""
    rng = random.Random(f"{trial.name} fillings")
    case = narrowed(trial.case)
    seen: dict[str, set[bool]] = {name: set() for name in case.spec.requirements}
    bad = set()
    for which in range(FILLINGS):
        filled = case if which == 0 else _filled(rng, trial, case)
        truly = judge(replace(filled, actions=(*filled.actions, trial.end))).verdicts
        # What was lost before a first value may have been one, and is no excuse (section 1).
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
    """Whether a name has had a value when the loss is over; events need none."""
    told = case.samples[: trial.lost.stop]
    values = (one.values[name] for one in told if name in one.values)
    return name in case.spec.events or any(value is not None and value == value for value in values)


def _filled(rng: random.Random, trial: Trial, case: Case) -> Case:
    """The case of a trial with something else in place of what was lost."""
    samples = list(case.samples)
    names = {*trial.names}
    others: Any = random_trace(rng, case.spec, TraceProfile()).samples or samples
    for place in trial.lost:
        told = samples[place].values
        heard = {n: v for n, v in told.items() if n not in names}
        may = names & told.keys() if trial.is_named else names
        values = {n: v for n, v in rng.choice(others).values.items() if n in may}
        samples[place] = Sample(samples[place].t, heard | values)
    return replace(case, actions=tuple(samples))


def outcomes(name: str, door: Door, count: int, seed: object, folder: Path) -> Iterator[Outcome]:
    """What comes of so many trials at a door."""
    for trial in islice(trials(name, seed, folder), count):
        yield outcome(trial, door(trial))
        shutil.rmtree(trial.folder)


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
