"""A random run of which something is to be lost, and what its verdicts are worth then."""

from __future__ import annotations

import itertools
import random
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any

from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from tests.tools.differential import cases_of
from tests.tools.law import judge, word
from tests.tools.sound import is_spoken_of, narrowed

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
