"""The core against the oracle and a tableau, and with lost data filled in."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from tests.tools.build import requirement, spec_over
from tests.tools.common_fragment import unrolled
from tests.tools.compare import Key, key_of
from tests.tools.differential import Campaign, campaign, case_of, cases_of
from tests.tools.doors import content_of, whole
from tests.tools.drive import drive
from tests.tools.forms import Compiler, Maker
from tests.tools.judgement import Judgement
from tests.tools.law import judge as oracle
from tests.tools.ltl3 import Letter, Tableau
from tests.tools.random_specs import random_ltl, random_mtl
from tests.tools.sound import is_spoken_of, narrowed, overturned

from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_formula
from rvmon.monitor.robustness import Robustness, RobustnessMonitor
from rvmon.session import Spec
from rvmon.testing.generate import BOOLS, chance
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, show_case
from rvmon.testing.law.margins import margins
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict

Figures = Mapping[Key, tuple[float, float, float]]
"""For each attempt the bounds of its robustness, `low` and `high`, and `kept`."""

_MANY, _ALONE = Profile(many=8), Profile(requirements=1)
_LONG, _USUAL = TraceProfile(long=8), TraceProfile()

TABLEAU_MOST = 8
"""The most temporal operators of a formula: with more, the tableau takes too long."""


def judge_verdicts(
    found: Campaign,
    seed: int,
    numbers: range,
    *,
    forms: str = "c",
    traces: int = 1,
    windows: int = 0,
    letters: int = 0,
    online_every: int = 10,
    profile: Profile = _MANY,
    trace: TraceProfile = _LONG,
) -> None:
    """The core against the oracle: verdicts, instants, records, in all time models.

    Args:
        found: gets the results.
        seed: determines the cases, together with the numbers.
        numbers: of the specifications.
        forms: forms of the core, separated by commas: `c`, `c rows`, `c+next`, `c+interrupt`, …
        traces: number of traces for each specification.
        windows: percentage of specifications with nested windows.
        letters: percentage of specifications that read 17 propositions at once.
        online_every: the result of each call is compared in every n-th case.
        profile: of the specifications.
        trace: profile of the traces.
    """
    compiler = Compiler()
    own_found = campaign(
        {form: Maker(form, compiler) for form in forms.split(",")},
        [f"{seed}/{number}" for number in numbers],
        profile,
        trace,
        each=traces,
        online_every=online_every,
        windows=windows,
        letters=letters,
    )
    found.counts += own_found.counts
    found.disagreements += own_found.disagreements


def by_samples(case: Case) -> Figures:
    """Robustness from a monitor, sample by sample."""
    monitor = RobustnessMonitor(Spec(case.spec)._compiled, sources=case.names)
    last, returned = drive(monitor, case)
    told = (one for several in (*returned, last) for one in several or ())
    return {key_of(one): _bounds(one.robustness) for one in told}


def by_arrays(case: Case) -> Figures:
    """Robustness of a recording in columns."""
    columns: dict[str, Any] = {"t_ns": np.array([one.t for one in case.samples], np.int64)}
    for name in sorted(case.names or ()):
        columns[name] = np.array([one.values[name] for one in case.samples])
    until = None if case.end is None else case.end * 1e-9
    found = Spec(case.spec).robustness(columns, until=until, allow_missing=True)
    both = {False: found.attempts, True: found.doubtful}
    return {
        (name, in_doubt, number): _bounds(one)
        for in_doubt, own in both.items()
        for (name, number), one in own.items()
    }


def _bounds(one: Robustness) -> tuple[float, float, float]:
    return one.low, one.high, one.kept


def _in_columns(case: Case) -> Case:
    """The case in columns: each sample updates all names, and there are no outages."""
    content = whole(content_of(random.Random(len(case.actions)), case))
    samples = tuple(Sample(t, cells) for t, cells in content.rows)
    return replace(case, actions=samples, names=frozenset(content.columns), outages=())


def _figures_differ(ours: Callable[[Case], Figures], case: Case) -> list[str]:
    """The differences between the figures of a way and those of the oracle."""
    case = _in_columns(case) if ours is by_arrays else case
    if not case.samples:
        return []
    try:
        found = ours(case)
    except Exception as error:  # noqa: BLE001 - whatever it raises is a finding
        return [f"raised {type(error).__name__}: {error}"]
    judgement = Judgement(case)
    expected = margins(judgement.followings, judgement.outcomes, case.spec.time)
    return [
        f"{key}: {found.get(key)}, expected {expected.get(key)}"
        for key in sorted({*expected, *found})
        if found.get(key) != expected.get(key)
    ]


def judge_robustness(
    found: Campaign,
    seed: int,
    numbers: range,
    *,
    profile: Profile = _MANY,
    traces: TraceProfile = _USUAL,
) -> None:
    """Robustness, by samples and by arrays, against its oracle."""

    def ways(_: int, case: Case) -> Iterator[tuple[str, Callable[[Case], list[str]]]]:
        for name, ours in {"samples": by_samples, "arrays": by_arrays}.items():
            found.counts[f"measured by {name}"] += bool(case.samples)
            yield name, partial(_figures_differ, ours)

    drawn = partial(cases_of, profile=profile, traces=traces, number=8)
    for number in numbers:
        found.compare(drawn, f"margins {seed}/{number}", ways, 1)


def judge_fillings(
    found: Campaign,
    seed: int,
    numbers: range,
    *,
    fillings: int = 8,
    profile: Profile = _ALONE,
) -> None:
    """Green never hides a failure: lost data is filled in, and no verdict may change.

    `fillings` fillings are tried for each run. In every other run stretches of time are lost; in
    every fourth run nothing else is lost.
    """
    for number in numbers:
        stretches, alone = number % 2 == 1, number % 4 == 1
        traces = TraceProfile(unknowns=not alone, outages=100 if stretches else 0)
        drawn = case_of(f"{seed}/{number}", replace(profile, stale=not alone), traces)
        case = narrowed(drawn)
        if not (alone or is_spoken_of(case.spec)):
            found.counts["not spoken of"] += 1
            continue
        rng = random.Random(f"{seed}/{number}")
        tried = overturned(rng, case, fillings, oracle, whole=not alone)
        found.counts.update(f"verdict {verdict}" for verdict in tried.verdicts.values())
        found.counts["turned by a filling that may"] += tried.is_split
        if tried.overturning is not None:
            shown = f"{show_case(case)}\nfilled in:\n{show_case(tried.overturning)}"
            found.disagreements.append(f"number {number}: {tried.verdicts}\n{shown}")


def judge_forecasts(
    found: Campaign, seed: int, numbers: range, *, words: int = 20, timed: bool = False
) -> None:
    """Verdicts and forecasts of open attempts against a tableau.

    Each formula is judged on `words` words. Timed formulas have windows of a few ticks, in held
    time, and are unrolled for the tableau. A forecast that only the tableau gives counts as missed.
    """
    for number in numbers:
        rng = random.Random(f"{seed}/{number}")
        formula = (random_mtl if timed else random_ltl)(rng, rng.randint(1, 4))
        tableau = Tableau.of(unrolled(formula), TABLEAU_MOST)
        if tableau is None:
            found.counts[f"passed over: more than {TABLEAU_MOST} temporal operators"] += 1
            continue
        found.counts["formulas"] += 1
        time = TimeModel.HELD if timed else TimeModel.SAMPLED
        kinds = dict.fromkeys(BOOLS, Kind.BOOL)
        spec = Spec(spec_over(kinds, requirement(formula), time))
        for _ in range(words):
            places = range(rng.randint(1, 8))
            word = [frozenset(name for name in BOOLS if chance(rng, 50)) for _ in places]
            for length, (decided, ours) in enumerate(_said(spec, word), 1):
                possible = tableau.possible(word[:length])
                wanted = next(iter(possible)) if len(possible) == 1 else None
                found.counts[f"{'decided' if decided else 'forecast'} {_SIGNS[ours]}"] += 1
                if timed and ours is None and wanted is not None:
                    found.counts["missed"] += 1
                elif ours is not wanted:
                    letters = " ".join("".join(sorted(x)) or "-" for x in word[:length])
                    found.disagreements.append(
                        f"number {number}: {format_formula(formula)} on {letters}: "
                        f"tableau {_SIGNS[wanted]}, monitor {_SIGNS[ours]}"
                    )


_SIGNS = {True: "P", False: "F", None: "either"}


def _said(spec: Spec, word: Sequence[Letter]) -> Iterator[tuple[bool, bool | None]]:
    """For each position, whether the attempt is decided, and its verdict or forecast."""
    monitor = spec.monitor()
    decided: Verdict | None = None
    for t, letter in enumerate(word):
        for attempt in monitor.step_ns(t, {name: name in letter for name in BOOLS}):
            decided = attempt.verdict
        value = monitor.open[0].forecast if decided is None else decided
        yield decided is not None, None if value is None else value is Verdict.PASS
