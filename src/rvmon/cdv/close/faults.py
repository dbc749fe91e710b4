"""Extend a suite by tests that kill further mutants; compare choices of tests by their kills."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.close.outcome import Choice, Closed, Trade
from rvmon.cdv.mutation.baseline import Suite, mutated_code, record_suite
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.mutation.python_mutants import HELD_OUT, Mutant, code_mutants
from rvmon.cdv.mutation.survivors import equivalents
from rvmon.cdv.system import Code
from rvmon.coverage.ranking import smallest

Killers = Mapping[str, frozenset[str]]
"""The tests that kill each killed mutant, by its identity; empty if its process was lost."""


def with_mutants(
    campaign: Campaign,
    robot: str,
    closed: Closed,
    mutants: int,
    *,
    jobs: int,
    progress: Callable[[float], None] = lambda _: None,
) -> Closed:
    """Add to a suite the fewest played tests that kill the mutants which it misses.

    About a third of the mutants is held out and does not influence the choice of tests: how many of
    these a choice kills estimates how many unknown faults it would find.

    Args:
        campaign: the campaign.
        robot: name of the robot.
        closed: the closed campaign.
        mutants: the number of mutants to play; those declared equivalent are not used.
        jobs: number of processes.
        progress: called with the share that is done, from 0 to 1.

    Returns:
        The closed campaign with the larger suite and a `Trade`.

    Raises:
        RvmonError: the campaign measures no code, or none of the tests has a result.
    """
    played = [test.played.job.test for test in closed.tests]
    suite = record_suite(campaign, robot, played, jobs=jobs)
    drawn = _sample(mutated_code(campaign), mutants)
    steps = len(closed.choices) + 3

    def killers(
        names: Sequence[str], mutants_played: Sequence[Mutant], step: int, *, every: bool = False
    ) -> Killers:
        found = _killers(_subset(suite, names), mutants_played, jobs, every=every)
        progress(step / steps)
        return found

    choices = []
    kills: Killers = {}
    for step, (times, names) in enumerate(closed.choices.items(), start=1):
        kills = killers(names, drawn, step)
        choices.append(_choice(times, len(names), kills, drawn))
    kept = closed.choices[max(closed.choices)]
    missed = [mutant for mutant in drawn if mutant.identity not in kills]
    others = [name for name in suite.tests if name not in kept]
    by_others = killers(others, missed, steps - 2)
    choosing = [
        mutant for mutant in missed if mutant.identity in by_others and mutant.third != HELD_OUT
    ]
    # So far, playing a mutant stopped at its first killer. To find the fewest tests, all killers
    # among the candidates must be known.
    candidates = dict.fromkeys(name for one in choosing for name in by_others[one.identity])
    added = _fewest_tests(killers([*candidates], choosing, steps - 1, every=True))
    by_added = killers(added, missed, steps)
    choices.append(_choice(None, len(kept) + len(added), {**kills, **by_added}, drawn))
    everything = {**kills, **by_others}
    choices.append(_choice(0, len(suite.tests), everything, drawn))
    suite_names = {*added, *(played.job.test.name for played in closed.suite)}
    return replace(
        closed,
        suite=[test.played for test in closed.tests if test.played.job.test.name in suite_names],
        trade=Trade(
            sum(mutant.third != HELD_OUT for mutant in drawn),
            sum(mutant.third == HELD_OUT for mutant in drawn),
            tuple(choices),
        ),
    )


def _sample(code: Code, count: int) -> list[Mutant]:
    """`count` mutants, or all if there are fewer, spread evenly over the code."""
    all_mutants = code_mutants(code)
    known = {} if code.equivalent is None else equivalents(code.equivalent, all_mutants)
    left = [mutant for mutant in all_mutants if mutant.identity not in known]
    count = min(count, len(left))
    return [left[place * len(left) // count] for place in range(count)]


def _subset(suite: Suite, names: Sequence[str]) -> Suite:
    tests = {name: suite.tests[name] for name in names if name in suite.tests}
    return replace(suite, tests=tests, recorded={name: suite.recorded[name] for name in tests})


def _killers(suite: Suite, mutants: Sequence[Mutant], jobs: int, *, every: bool) -> Killers:
    if not suite.tests or not mutants:
        return {}
    tried = play_mutants(suite, mutants, jobs=jobs, every=every)
    return {
        trial.mutant.identity: frozenset(finding.test for finding in trial.findings if finding.test)
        for trial in tried
        if trial.killed
    }


def _fewest_tests(killers: Killers) -> list[str]:
    mutants = [identity for identity, names in killers.items() if names]
    tests = sorted({name for names in killers.values() for name in names})
    rows = [
        {place: 1 for place, identity in enumerate(mutants) if test in killers[identity]}
        for test in tests
    ]
    smallest_set = smallest(rows, dict.fromkeys(range(len(mutants)), 1))
    return [tests[place] for place in smallest_set.places]


def _choice(times: int | None, tests: int, kills: Killers, drawn: Sequence[Mutant]) -> Choice:
    held_out = sum(mutant.identity in kills for mutant in drawn if mutant.third == HELD_OUT)
    return Choice(times, tests, len(kills) - held_out, held_out)
