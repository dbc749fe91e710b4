"""An engine against the oracle on random cases; a disagreement is shrunk and shown."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial

from rvmon.errors import RvmonError
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case, show_case
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.law.syntax import intervals
from rvmon.verdict.attempt import Attempt, Decision
from tests.tools.chains import random_chain
from tests.tools.compare import differences
from tests.tools.drive import Monitored, drive
from tests.tools.features import Feature, features
from tests.tools.frame import frame_differences
from tests.tools.health import health_differences
from tests.tools.held_back import HeldBack
from tests.tools.judgement import Judgement
from tests.tools.kinds import kinds_of
from tests.tools.letters import random_letters
from tests.tools.online import (
    differences_after_end,
    is_online,
    is_silent,
    online_differences,
)
from tests.tools.shrink import shrink

MakeMonitor = Callable[[Case], Monitored | None]
"""A fresh monitor for the spec and the sources of a case; `None`: it judges no such specs."""


@dataclass(slots=True)
class Mix:
    """What cases were made of; mixes of parts add up.

    Attributes:
        pairs: of a specification and a trace.
        attempts: by verdict.
        decisions: by what settled them.
        on_bound: attempts that the prefix decided at a window's last instant, or a tick later.
        late: attempts that the prefix decided after the third sample.
        kinds: of the pairs, each of which may be of several (see `tests.tools.kinds`).
        features: of the specifications: operators with what they met.
    """

    pairs: int = 0
    attempts: Counter[str] = field(default_factory=Counter)
    decisions: Counter[str] = field(default_factory=Counter)
    on_bound: int = 0
    late: int = 0
    kinds: Counter[str] = field(default_factory=Counter)
    features: Counter[Feature] = field(default_factory=Counter)

    def add(self, other: Mix) -> None:
        """Take in the figures of another part."""
        self.pairs += other.pairs
        self.attempts += other.attempts
        self.decisions += other.decisions
        self.on_bound += other.on_bound
        self.late += other.late
        self.kinds += other.kinds
        self.features += other.features

    def count(self, judgement: Judgement) -> None:
        """Take in a case."""
        spec = judgement.case.spec
        self.pairs += 1
        self.features.update(features(spec))
        self.kinds.update(kinds_of(judgement.case, judgement.report))
        third = (
            max(sample.t for sample in judgement.case.samples[:3]) if judgement.case.samples else 0
        )
        for attempt in judgement.report.attempts:
            self.attempts[attempt.verdict.value] += 1
            self.decisions[attempt.decision.value] += 1
            self.late += attempt.decision is Decision.PREFIX and (attempt.decided or 0) > third
            self.on_bound += decided_on_bound(spec, attempt)


@dataclass(slots=True)
class Tally:
    """What came of one engine; tallies of parts add up.

    Attributes:
        pairs: cases judged.
        refused: further cases, whose specification the engine does not judge.
        disagreements: one text each, with seed, differences and the shrunk case.
    """

    pairs: int = 0
    refused: int = 0
    disagreements: list[str] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Take in the figures of another part."""
        self.pairs += other.pairs
        self.refused += other.refused
        self.disagreements += other.disagreements


@dataclass(slots=True)
class Campaign:
    """What was judged, and what came of each engine; parts add up."""

    mix: Mix
    tallies: dict[str, Tally]

    @property
    def disagreements(self) -> list[str]:
        """Those of all engines."""
        return [text for tally in self.tallies.values() for text in tally.disagreements]

    def add(self, other: Campaign) -> None:
        """Take in the figures of another part."""
        self.mix.add(other.mix)
        for name, tally in other.tallies.items():
            self.tallies.setdefault(name, Tally()).add(tally)


def cases_of(
    seed: object,
    profile: Profile,
    traces: TraceProfile,
    number: int = 1,
    *,
    windows: int = 0,
    letters: int = 0,
) -> Iterator[Case]:
    """The random cases of a seed, the same for ever: one specification, so many traces.

    Args:
        seed: whatever tells cases apart.
        profile: of the spec.
        traces: of the traces.
        number: of traces.
        windows: per cent of the specs that are windows, and `until`, within windows.
        letters: per cent of the others that speak of 17 propositions at once.
    """
    rng = random.Random(str(seed))
    if windows and rng.random() * 100 < windows:
        spec = random_chain(rng, untils=rng.random() < 0.7)
    elif letters and rng.random() * 100 < letters:
        spec = random_letters(rng)
    else:
        spec = random_spec(rng, profile)
    for _ in range(number):
        yield random_trace(rng, spec, traces)


def case_of(seed: object, profile: Profile, traces: TraceProfile) -> Case:
    """The first random case of a seed.

    >>> repr(case_of(1, Profile(), TraceProfile())) == repr(case_of(1, Profile(), TraceProfile()))
    True
    """
    return next(cases_of(seed, profile, traces))


def disagreements(case: Case, make: MakeMonitor, *, online: bool = False) -> list[str]:
    """How a monitor departs from the oracle on a case; empty if it does not.

    Args:
        case: what to judge.
        make: gives a fresh monitor.
        online: whether to check as well what it says at each action.
    """
    return _found(Judgement(case), make, online) or []


def _found(judgement: Judgement, make: MakeMonitor, online: bool) -> list[str] | None:
    """The disagreements on a case; `None` if it is refused."""
    case, expected = judgement.case, judgement.report
    try:
        monitor = make(case)
        if monitor is None:
            return None
        actual, _ = drive(monitor, case)
        found = differences(expected, actual)
        if is_online(monitor):
            found += frame_differences(expected, actual)
            found += differences_after_end(case, monitor, actual)
        if is_online(monitor) and not case.outages:
            provoked = monitor.health() if isinstance(monitor, HeldBack) else []
            found += health_differences(case.spec, [*judgement.health, *provoked], actual.health)
            found += judgement.seen.differences(actual) if not found else ()
        asked = online and not (found or case.outages or is_silent(monitor))
        again = make(case) if asked else None
        if again is not None:
            found = online_differences(judgement, again)
    except Exception as error:  # noqa: BLE001 - whatever an engine raises is a finding
        return [f"raised {type(error).__name__}: {error}"]
    return found


def campaign(
    make: MakeMonitor,
    seeds: Iterable[object],
    profile: Profile,
    traces: TraceProfile,
    *,
    each: int = 1,
    online_every: int = 10,
    shrunk: int = 3,
) -> Tally:
    """Judge the cases of each seed with one engine and the oracle; see `campaign_of`."""
    found = campaign_of(
        {"": make}, seeds, profile, traces, each=each, online_every=online_every, shrunk=shrunk
    )
    return found.tallies[""]


def campaign_of(
    engines: Mapping[str, MakeMonitor],
    seeds: Iterable[object],
    profile: Profile,
    traces: TraceProfile,
    *,
    each: int = 1,
    online_every: int = 10,
    shrunk: int = 3,
    windows: int = 0,
    letters: int = 0,
) -> Campaign:
    """Judge the cases of each seed with the oracle, once, and with some engines.

    Args:
        engines: by name, what gives a fresh monitor.
        seeds: whatever tells cases apart.
        profile: of the specs.
        traces: of the traces.
        each: so many traces for the specification of each seed, which is compiled once.
        online_every: in every so many-th case the return values of all calls are checked too;
            0 for none.
        shrunk: so many disagreements of an engine are shrunk and shown, the others only named.
        windows: see `cases_of`.
        letters: see there, too.
    """
    campaign = Campaign(Mix(), {name: Tally() for name in engines})
    cases = (
        (seed, case)
        for seed in seeds
        for case in cases_of(seed, profile, traces, each, windows=windows, letters=letters)
    )
    for index, (seed, case) in enumerate(cases):
        asked = online_every > 0 and index % online_every == 0
        judgement = Judgement(case)
        campaign.mix.count(judgement)
        for name, make in engines.items():
            tally = campaign.tallies[name]
            found = _found(judgement, make, asked)
            tally.refused += found is None
            tally.pairs += found is not None
            if found:
                lines = [f"{name} seed {seed}".lstrip(), *found]
                if len(tally.disagreements) < shrunk:
                    lines.append(_shrunk(case, make, asked))
                tally.disagreements.append("\n".join(lines))
    return campaign


def _shrunk(case: Case, make: MakeMonitor, online: bool) -> str:
    judged = partial(disagreements, make=make, online=online)

    def disagree(smaller: Case) -> bool:
        try:
            return bool(judged(smaller))
        except RvmonError:  # the smaller case is none that the law speaks of
            return False

    small = shrink(case, disagree)
    return "\n".join(["shrunk:", *judged(small), show_case(small)])


def decided_on_bound(spec: CheckedSpec, attempt: Attempt) -> bool:
    """Whether an attempt was decided as a window (of an operator at its trigger) closed.

    That is: b or b + 1 ticks after the trigger, for the b > 0 of an interval in the consequent.
    """
    if attempt.decision is not Decision.PREFIX or attempt.decided is None:
        return False
    after = attempt.decided - attempt.triggered
    windows = intervals(spec.requirements[attempt.requirement].consequent)
    return any(window.high and after in (window.high, window.high + 1) for window in windows)
