"""Closure: make and play tests until every reachable item of the coverage model is hit.

`close` is the loop. `goals` knows the open items and asks the model for witnesses and proofs,
`vary_test` changes tests and learns which changes pay off, and `propose` chooses the next test.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

from rvmon.cdv.campaign import Campaign, unreachable_items
from rvmon.cdv.campaign_plan import Job, Played
from rvmon.cdv.close.goals import Goals, Witnesses
from rvmon.cdv.close.outcome import Added, Closed
from rvmon.cdv.close.propose import Proposer
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.play import INTERRUPTED, JobQueue, outcomes
from rvmon.coverage import Ending, model_of
from rvmon.coverage.ranking import Smallest, smallest
from rvmon.verdicts import Verdict

__all__ = ["Added", "Budget", "Closed", "close"]


BATCH = 4
"""Tests that are played before learning from them; independent of the number of processes, so that
the tests are, too."""


MARGIN = 2
"""The number of tests in a suite that meet each goal, if so many were found."""


@dataclass(frozen=True, slots=True)
class Budget:
    """The limits at which closing gives up."""

    tests: int = 400  # the most tests that are played
    seconds: float | None = None  # wall time after which no batch is started; `None`: unlimited


Progress = Callable[[int, int], None]
"""Called with the number of goals that are met, and the number of all goals."""


def close(
    campaign: Campaign,
    robot: str,
    *,
    seed: int = 1,
    strategies: Sequence[str] = (),
    margin: int = MARGIN,
    budget: Budget = Budget(),
    jobs: int | str | None = None,
    progress: Progress | None = None,
) -> Closed:
    """Close the holes of a campaign's coverage, starting without any test.

    Tests are played in small batches. Each aims at an open goal: if the campaign has a model which
    knows a run to the goal, the test follows that run; otherwise it is a change of a test that came
    near, or a new test; what paid off so far is more likely. The same seed gives the same tests on
    any number of processes, unless `budget.seconds` ends the search.

    Args:
        campaign: the campaign.
        robot: name of the robot.
        seed: determines everything.
        strategies: the strategies that tests are drawn from; default: those of `Closing`.
        margin: the number of tests in the suite that meet each goal, if so many were found. One
            test per goal covers the same but sees fewer faults.
        budget: the limits at which it gives up.
        jobs: number of processes, or address of a Dask scheduler; default: one process per core.
        progress: called after each test.

    Raises:
        TestError: a test cannot be made, or played.
        UnknownNameError: the campaign declares an unknown item unreachable.
        RvmonError: a specification is wrong, or a system cannot be made.

    Source: Fine and Ziv, Coverage Directed Test Generation for Functional Verification using
    Bayesian Networks, DAC 2003 (closing the loop from coverage to generation); Zalewski, American
    Fuzzy Lop, 2014 (mutating the nearest inputs); Blom, Hessel, Jonsson, Pettersson, FATES 2004
    (tests from runs of a timed model); Ma, Franco, McCluskey, An experimental chip to evaluate test
    techniques, ITC 1995 (covering each goal several times finds faults that nobody modelled).
    """
    started = time.monotonic()
    campaign = replace(campaign, robots={robot: campaign.robots[robot]})
    model = campaign.closing.model
    describes = model is not None and robot in (model.robots or campaign.robots)
    witnesses = None if model is None else Witnesses(model, describes=describes)
    goals = _goals(campaign, robot, witnesses)
    names = strategies or campaign.closing.strategies or tuple(campaign.strategies)
    proposer = Proposer(campaign, robot, goals, names, seed, witnesses)
    tests: list[Added] = []
    waiting = JobQueue()
    ended = ""
    try:
        with closing(outcomes(campaign, waiting, jobs=jobs, controls=False)) as results:
            while goals.open and not ended:
                proposals = proposer.batch(min(BATCH, budget.tests - len(tests)))
                waiting.jobs.extend(Job(proposal.test, robot) for proposal in proposals)
                for proposal in proposals:
                    outcome, _ = next(results)  # takes its job from `waiting`
                    if witnesses is not None and proposal.witness is not None:
                        shown = witnesses.shown(proposal.witness, proposal.test.name, outcome.hits)
                        outcome = replace(outcome, hits={**outcome.hits, **shown})
                    played = Played(Job(proposal.test, robot), outcome)
                    added = goals.add(proposal.test.name, outcome.hits)
                    proposer.learn(proposal, played, added=bool(added))
                    tests.append(Added(played, proposal.origin, added, goals.met))
                    if progress is not None:
                        progress(goals.met, goals.met + len(goals.open))
                if not proposals and goals.open:
                    ended = "no further test can be made"
                elif len(tests) >= budget.tests:
                    ended = f"after {budget.tests} tests"
                elif budget.seconds is not None and time.monotonic() - started > budget.seconds:
                    ended = f"after {budget.seconds:g} s"
    except KeyboardInterrupt:
        ended = INTERRUPTED
    choices = {}
    for times in range(1, margin + 1):
        smallest_set = _smallest(tests, goals, times)
        choices[times] = [tests[place].played.job.test.name for place in smallest_set.places]
    kept = {*smallest_set.places, *_first_failures(tests)}
    return Closed(
        tests=tests,
        suite=[test.played for place, test in enumerate(tests) if place in kept],
        choices=choices,
        fewest=smallest_set.at_least,
        goals=goals.met + len(goals.open),
        share=goals.share,
        proved=goals.proved,
        argued={goal: why for goal, why in goals.argued.items() if goal not in goals.proved},
        open=goals.holes() if witnesses is None else witnesses.explained(goals.holes()),
        wrong=goals.wrong,
        groups=() if witnesses is None else witnesses.groups,
        seconds=time.monotonic() - started,
        ended=ended if goals.open else "",
    )


def _goals(campaign: Campaign, robot: str, witnesses: Witnesses | None) -> Goals:
    model = coverage_model(campaign, robot)
    if witnesses is not None:
        model = model_of([*model.groups.values(), *witnesses.groups])
    return Goals(model, unreachable_items(campaign, robot, model, closing=True))


def _smallest(tests: Sequence[Added], goals: Goals, times: int) -> Smallest:
    """The smallest known set of tests that meets the same goals, each by up to `times` tests."""
    sought = goals.sought
    places = {goal: place for place, goal in enumerate(sought)}
    wanted = {places[goal]: count for goal, count in sought.items()}
    rows: list[dict[int, int]] = []
    for test in tests:
        hits = test.played.outcome.hits
        row = {
            places[group, item]: hit.count
            for group, items in hits.items()
            for item, hit in items.items()
            if (group, item) in places
        }
        if times > 1:
            # A second set of columns counts tests: each as one, however often it hits the goal.
            row |= {place + len(places): 1 for place in row}
        rows.append(row)
    if times > 1:
        wanted |= dict.fromkeys(range(len(places), 2 * len(places)), times)
    return smallest(rows, wanted)


def _first_failures(tests: Sequence[Added]) -> Iterator[int]:
    """The places of the first test with each failed requirement, illegal hit and bad ending."""
    seen: set[str] = set()
    for place, test in enumerate(tests):
        outcome = test.played.outcome
        ways = {name for name, verdict in outcome.verdicts.items() if verdict is Verdict.FAIL}
        ways |= {illegal.partition(" at ")[0] for illegal in outcome.illegal}
        ways |= {outcome.ending} - {Ending.COMPLETED}
        if ways - seen:
            seen |= ways
            yield place
