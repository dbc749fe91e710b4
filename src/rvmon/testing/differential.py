"""An engine against the oracle on random cases; a disagreement is shrunk and shown."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from rvmon.errors import RvmonError
from rvmon.spec.checked import CheckedSpec
from rvmon.testing.case import Case
from rvmon.testing.compare import differences, frame_differences
from rvmon.testing.drive import Monitored, drive
from rvmon.testing.features import Feature, features
from rvmon.testing.generate_spec import Profile, random_spec
from rvmon.testing.generate_trace import TraceProfile, random_trace
from rvmon.testing.health import health_differences
from rvmon.testing.law import judge, word
from rvmon.testing.online import Watched, differences_after_end, online_differences
from rvmon.testing.seen import seen_differences
from rvmon.testing.show import show_case
from rvmon.testing.shrink import shrink
from rvmon.testing.walk import intervals
from rvmon.verdict.attempt import Attempt, Decision

MakeMonitor = Callable[[Case], Monitored | None]
"""A fresh monitor for the spec and the sources of a case; `None`: it judges no such specs."""


@dataclass(slots=True)
class Tally:
    """What a campaign found; tallies of parts add up.

    Attributes:
        pairs: cases judged.
        refused: further cases, whose specification the engine does not judge.
        attempts: by verdict.
        decisions: by what settled them.
        on_bound: attempts that the prefix decided at a window's last instant, or a tick later.
        features: of the specifications: operators with what they met.
        disagreements: one text each, with seed, differences and the shrunk case.
    """

    pairs: int = 0
    refused: int = 0
    attempts: Counter[str] = field(default_factory=Counter)
    decisions: Counter[str] = field(default_factory=Counter)
    on_bound: int = 0
    features: Counter[Feature] = field(default_factory=Counter)
    disagreements: list[str] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Take in the figures of another part."""
        self.pairs += other.pairs
        self.refused += other.refused
        self.attempts += other.attempts
        self.decisions += other.decisions
        self.on_bound += other.on_bound
        self.features += other.features
        self.disagreements += other.disagreements


def cases_of(
    seed: object, profile: Profile, traces: TraceProfile, number: int = 1
) -> Iterator[Case]:
    """The random cases of a seed, the same for ever: one specification, so many traces."""
    dice = random.Random(str(seed))  # noqa: S311 - a seed is meant to be repeated
    spec = random_spec(dice, profile)
    for _ in range(number):
        yield random_trace(dice, spec, traces)


def case_of(seed: object, profile: Profile, traces: TraceProfile) -> Case:
    """The first random case of a seed.

    >>> case_of(1, Profile(), TraceProfile()) == case_of(1, Profile(), TraceProfile())
    True
    """
    return next(cases_of(seed, profile, traces))


def disagreements(case: Case, make: MakeMonitor, *, online: bool = False) -> list[str]:
    """How a monitor departs from the oracle on a case; empty if it does not.

    Args:
        case: what to judge.
        make: gives a fresh monitor.
        online: whether to check as well what it says at each action; costs one run of the oracle
            per action.
    """
    return _found(case, make, online) or []


def _found(case: Case, make: MakeMonitor, online: bool) -> list[str] | None:
    """The disagreements on a case; `None` if it is refused."""
    expected = judge(case)
    try:
        monitor = make(case)
        if monitor is None:
            return None
        actual, _ = drive(monitor, case)
        found = differences(expected, actual)
        if isinstance(monitor, Watched):
            found += frame_differences(expected, actual)
            found += health_differences(case, word(case), actual.health)
            found += seen_differences(case, word(case), actual) if not found else ()
            found += differences_after_end(case, monitor, actual)
        again = make(case) if online and not found else None
        if again is not None:
            found = online_differences(case, again)
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
    """Judge the cases of each seed with an engine and the oracle.

    Args:
        make: gives a fresh monitor.
        seeds: whatever tells cases apart.
        profile: of the specs.
        traces: of the traces.
        each: so many traces for the specification of each seed, which is compiled once.
        online_every: in every so many-th case the return values of all calls are checked too;
            0 for none.
        shrunk: so many disagreements are shrunk and shown, the others only named.
    """
    tally = Tally()
    cases = ((seed, case) for seed in seeds for case in cases_of(seed, profile, traces, each))
    for index, (seed, case) in enumerate(cases):
        online = online_every > 0 and index % online_every == 0
        found = _found(case, make, online)
        if found is None:
            tally.refused += 1
            continue
        count(tally, case)
        if found:
            lines = [f"seed {seed}", *found]
            if len(tally.disagreements) < shrunk:
                lines.append(_shrunk(case, make, online))
            tally.disagreements.append("\n".join(lines))
    return tally


def _shrunk(case: Case, make: MakeMonitor, online: bool) -> str:
    def disagree(smaller: Case) -> bool:
        try:
            return bool(disagreements(smaller, make, online=online))
        except RvmonError:  # the smaller case is none that the law speaks of
            return False

    small = shrink(case, disagree)
    return "\n".join(["shrunk:", *disagreements(small, make, online=online), show_case(small)])


def count(tally: Tally, case: Case) -> None:
    """Add the oracle's figures for a case."""
    tally.pairs += 1
    tally.features.update(features(case.spec))
    for attempt in judge(case).attempts:
        tally.attempts[attempt.verdict.value] += 1
        tally.decisions[attempt.decision.value] += 1
        tally.on_bound += decided_on_bound(case.spec, attempt)


def decided_on_bound(spec: CheckedSpec, attempt: Attempt) -> bool:
    """Whether an attempt was decided as a window (of an operator at its trigger) closed.

    That is: b or b + 1 ticks after the trigger, for the b > 0 of an interval in the consequent.
    """
    if attempt.decision is not Decision.PREFIX or attempt.decided is None:
        return False
    after = attempt.decided - attempt.triggered
    windows = intervals(spec.requirements[attempt.requirement].consequent)
    return any(window.high and after in (window.high, window.high + 1) for window in windows)
