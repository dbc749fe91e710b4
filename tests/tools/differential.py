"""An engine against the oracle on random cases; a disagreement is shrunk and shown."""

import itertools
import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import islice

from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace, show_case
from rvmon.testing.law.syntax import intervals
from rvmon.verdicts.attempt import Attempt, Decision
from tests.tools.compare import differences, frame_differences
from tests.tools.drive import Monitored, drive
from tests.tools.forms import HeldBack
from tests.tools.health import health_differences
from tests.tools.judgement import Judgement
from tests.tools.law import names_read
from tests.tools.online import differences_after_end, is_silent, online_differences
from tests.tools.random_specs import random_chain, random_letters
from tests.tools.shrink import shrink

MANY = 20
"""Requirements that are many."""

MakeMonitor = Callable[[Case], Monitored | None]
"""A fresh monitor for the spec and the sources of a case; `None`: it judges no such specs."""


@dataclass(slots=True)
class Campaign:
    """What cases were made of, and what came of them; those of parts add up.

    Attributes:
        counts: `pairs` of a specification and a trace, and of what kinds they were; attempts by
            verdict and by what settled them; of each engine, what it `judged`, and `refused`.
        disagreements: one text each, with seed, differences and the shrunk case.
    """

    counts: Counter[str] = field(default_factory=Counter)
    disagreements: list[str] = field(default_factory=list)

    def compare(
        self,
        drawn: Callable[[object], Iterator[Case]],
        seed: object,
        differs: Callable[[int, Case], Iterator[tuple[str, Callable[[Case], list[str]]]]],
        shrunk: int,
    ) -> None:
        """Hold what several ways say of the cases of a seed against what is right.

        Args:
            drawn: draws the cases of the seed.
            seed: whatever tells cases apart.
            differs: given a place and the case there, the name of each way with what says how it
                departs from what is right on a case; it is asked of others to shrink that one.
            shrunk: so many disagreements in all are shrunk and shown, the others only told.
        """
        for place, case in enumerate(drawn(seed)):
            for name, departs in differs(place, case):
                if wrong := departs(case):
                    lines = [f"{name}, seed {seed}", *wrong]
                    if len(self.disagreements) < shrunk:
                        lines += _shrunk_case(drawn, place, seed, departs)
                    self.disagreements.append("\n".join(lines))

    def count(self, judgement: Judgement) -> None:
        """Take in what a case is made of, by what the law says of it."""
        case, spec, report = judgement.case, judgement.case.spec, judgement.report
        counts, third = self.counts, max((s.t for s in case.samples[:3]), default=0)
        requirements = spec.requirements.values()
        read = {name for one in requirements for name in names_read(one)}
        kinds = {
            spec.time.value: True,
            "outages": bool(case.outages),
            "unknown values": any(None in s.values.values() for s in case.samples),
            "late first values": any(_is_late(case, name) for name in read & spec.signals.keys()),
            "doubt": any(attempt.in_doubt for attempt in report.attempts),
            "keys": any(one.for_each for one in requirements),
            "captures": any(one.captures for one in requirements),
            "many requirements": len(requirements) >= MANY,
        }
        counts["pairs"] += 1
        counts.update(f"pairs with {kind}" for kind, is_of in kinds.items() if is_of)
        for attempt in report.attempts:
            counts[f"attempts {attempt.verdict.value}"] += 1
            counts[f"settled by {attempt.decision.value}"] += 1
            late = attempt.decision is Decision.PREFIX and (attempt.decided or 0) > third
            counts["decided after the third sample"] += late
            counts["decided on a bound"] += decided_on_bound(spec, attempt)


def _is_late(case: Case, name: str) -> bool:
    """Whether the first known value of a signal comes behind the first sample."""
    told = ((one.t, one.values.get(name)) for one in case.samples)
    first = next((t for t, value in told if value is not None and value == value), None)
    return first is not None and first > case.samples[0].t


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
        seed: whatever tells cases apart; or what draws them.
        profile: of the spec.
        traces: of the traces.
        number: of traces.
        windows: per cent of the specs that are windows, and `until`, within windows.
        letters: per cent of the others that speak of 17 propositions at once.
    """
    rng = seed if isinstance(seed, random.Random) else random.Random(str(seed))
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
    """How a monitor departs from the oracle on a case; empty if it does not."""
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
        if not is_silent(monitor):
            found += frame_differences(expected, actual)
            found += differences_after_end(case, monitor, actual)
        if not (is_silent(monitor) or case.outages):
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
        shrunk: so many disagreements are shrunk and shown, the others only named.
        windows: see `cases_of`.
        letters: see there, too.
    """
    found, asked = Campaign(), itertools.cycle([True, *[False] * (online_every - 1)])
    drawn = partial(
        cases_of, profile=profile, traces=traces, number=each, windows=windows, letters=letters
    )

    def differs(_: int, case: Case) -> Iterator[tuple[str, Callable[[Case], list[str]]]]:
        judgement, online = Judgement(case), online_every > 0 and next(asked)
        found.count(judgement)
        for name, make in engines.items():
            wrong = _found(judgement, make, online)
            found.counts[f"{'refused' if wrong is None else 'judged'} by {name}"] += 1
            if wrong:
                yield name, partial(disagreements, make=make, online=online)

    for seed in seeds:
        found.compare(drawn, seed, differs, shrunk)
    return found


def _shrunk_case(
    drawn: Callable[[object], Iterator[Case]],
    place: int,
    seed: object,
    departs: Callable[[Case], list[str]],
) -> list[str]:
    """What still differs on a small case, which is made of the one that a seed draws there."""

    def shows(smaller: Case) -> bool:
        try:
            return bool(departs(smaller))
        except (RvmonError, KeyError):  # the law, or columns, do not speak of the smaller case
            return False

    small = shrink(lambda rng: next(islice(drawn(rng), place, None)), seed, shows)
    return ["shrunk:", *departs(small), show_case(small)]


def decided_on_bound(spec: CheckedSpec, attempt: Attempt) -> bool:
    """Whether an attempt was decided as a window (of an operator at its trigger) closed.

    That is: b or b + 1 ticks after the trigger, for the b > 0 of an interval in the consequent.
    """
    if attempt.decision is not Decision.PREFIX or attempt.decided is None:
        return False
    after = attempt.decided - attempt.triggered
    windows = intervals(spec.requirements[attempt.requirement].consequent)
    return any(window.high and after in (window.high, window.high + 1) for window in windows)
