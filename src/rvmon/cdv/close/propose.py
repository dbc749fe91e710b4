"""Propose the next test: a witness of the model, a change of a near test, or a new one."""

from __future__ import annotations

import heapq
import random
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count
from typing import TypeVar

from msgspec import structs

from rvmon.cdv.campaign import STRATEGY, Campaign
from rvmon.cdv.campaign_plan import Played, plan
from rvmon.cdv.close.goals import Goals, Proof, Witness, Witnesses
from rvmon.cdv.close.vary_test import Draw, Learned, Mutator
from rvmon.cdv.test import Test, TestError, blamed, from_json, to_json
from rvmon.coverage import Subject
from rvmon.coverage.holes import Goal, nearness

_Option = TypeVar("_Option", bound=Hashable)

WITNESSES = 2
"""The most tests per run of the model; their times differ."""

DRAWN = 32
"""The number of tests that a strategy is asked for at a time."""

ASKED = 8
"""The most goals tried, per test of a batch, before a batch is returned incomplete."""

NEAREST = 3
"""The number of nearest tests from which one is drawn to be changed."""

_SPECIFIC_FIRST = (Subject.CROSS, Subject.COVERPOINT, Subject.GOAL, Subject.REQUIREMENT)


@dataclass(frozen=True, slots=True)
class Proposal:
    """A test to be played."""

    test: Test
    origin: str  # how it was made, in words
    goal: Goal  # the goal that it aims at
    drawn: Sequence[Draw] = ()  # the choices that made it
    witness: Witness | None = None  # the run of the model that it follows


class Proposer:
    """Proposes tests, each aimed at an open goal."""

    def __init__(
        self,
        campaign: Campaign,
        robot: str,
        goals: Goals,
        strategies: Sequence[str],
        seed: int,
        witnesses: Witnesses | None,
    ) -> None:
        self._goals = goals
        self._witnesses = witnesses
        self._rng = random.Random(f"close/{seed}")  # noqa: S311 - repeatable, not secret
        self._learned = Learned()
        self._mutator = Mutator(campaign.test, campaign.closing.fixed, self._learned)
        self._written = _of_strategies(campaign, campaign.closing.written, robot, 1, seed)
        self._streams = {
            name: _stream(campaign, name, robot, self._rng.getrandbits(32)) for name in strategies
        }
        self._campaign = campaign
        self._count = 0
        self._tests: list[Played] = []
        self._draws: dict[str, Sequence[Draw]] = {}
        self._tries: Counter[Goal] = Counter()
        self._nearness: defaultdict[Goal, float] = defaultdict(float)
        self._followed: Counter[str] = Counter()

    def batch(self, size: int) -> list[Proposal]:
        """Propose up to `size` tests, which aim at different goals where possible.

        There are fewer tests if no goal is open, or if no further test can be made.

        Raises:
            TestError: a test cannot be made, or cannot be written to a file.
            ModelError: the campaign's query for an item is not a valid query of its model.
        """
        proposals: list[Proposal] = []
        aimed: set[Goal] = set()
        for _ in range(ASKED * size):
            goals = self._goals.open
            if len(proposals) == size or not goals:
                break
            goal = min(goals, key=lambda one: (one in aimed, self._tries[one], self._rank(one)))
            self._tries[goal] += 1
            aimed.add(goal)
            proposal = self._from_model(goal)
            if proposal is None and goal not in self._goals.proved:
                proposal = self._without_model(goal)
            if proposal is not None:
                proposals.append(proposal)
        return proposals

    def learn(self, proposal: Proposal, played: Played, *, added: bool) -> None:
        """Learn from a played test.

        A test paid off if it met a goal first, or came nearer to its goal than any test before.
        """
        near = nearness(proposal.goal, played.outcome.hits, self._goals.model)
        is_nearer = near > self._nearness[proposal.goal]
        self._nearness[proposal.goal] = max(near, self._nearness[proposal.goal])
        self._tests.append(played)
        self._draws[played.job.test.name] = proposal.drawn
        self._learned.learn(proposal.drawn, paid=added or is_nearer)

    def _rank(self, goal: Goal) -> tuple[bool, int]:
        """Goals that the model knows come first, then specific ones, as these meet others, too."""
        is_known = self._witnesses is not None and self._witnesses.knows(goal)
        subject = self._goals.model.groups[goal[0]].subject
        places = [place for place, one in enumerate(_SPECIFIC_FIRST) if one is subject]
        return not is_known, places[0] if places else len(_SPECIFIC_FIRST)

    def _from_model(self, goal: Goal) -> Proposal | None:
        """A test that follows a run of the model to a goal; if none exists, notes the proof."""
        answer = None if self._witnesses is None else self._witnesses.answer(goal)
        if isinstance(answer, Proof):
            self._goals.proved[goal] = answer.query
        if not isinstance(answer, Witness) or self._followed[answer.query] >= WITNESSES:
            return None
        assert self._witnesses is not None, "it has answered"
        self._followed[answer.query] += 1
        name, seed = self._next_name(), self._rng.getrandbits(32)
        origin = f"a run of the model that shows {answer.query}"
        witnesses = self._witnesses
        test = self._made_by_campaign(
            "closing.model.make", lambda: witnesses.test(answer, name, seed)
        )
        return Proposal(self._renamed(test, name, origin), origin, goal, (), answer)

    def _without_model(self, goal: Goal) -> Proposal | None:
        """The next written test, or a changed, biased or drawn one; `None` if none can be made."""
        drawn: list[Draw] = []
        written = next(self._written, None)
        if written is not None:
            return self._as_proposal(written, goal, drawn)
        ways = [*(["draw"] if self._streams else []), *(["change"] if self._tests else [])]
        ways += ["bias"] if self._campaign.closing.biased is not None else []
        way = self._learned.choose(self._rng, "way", ways, drawn) if ways else ""
        proposal = None
        if way == "change":
            proposal = self._from_change(goal, drawn)
        elif way == "bias":
            proposal = self._from_choices(goal, drawn)
        return proposal or self._from_strategy(goal, drawn)

    def _from_change(self, goal: Goal, drawn: list[Draw]) -> Proposal | None:
        """One of the tests that came nearest to a goal, changed."""
        nearest = self._rng.choice(self._nearest(goal)).job.test
        others = [test.job.test for test in self._tests]
        made = self._mutator.mutated(nearest, others, self._rng, drawn)
        if made is None:
            return None
        origin = f"{nearest.name}, changed towards {goal[0]}: {goal[1]}"
        # The expectations of the nearest test do not apply to the changed test.
        made = structs.replace(made, expected={}, reaches={})
        return Proposal(self._renamed(made, self._next_name(), origin), origin, goal, drawn)

    def _from_choices(self, goal: Goal, drawn: list[Draw]) -> Proposal | None:
        """A test of `Closing.biased`, which prefers the choices of the tests nearest to a goal."""
        if self._campaign.closing.biased is None:
            return None
        near = [self._draws.get(played.job.test.name, ()) for played in self._nearest(goal)]

        def choose(name: str, options: Sequence[_Option], /) -> _Option:
            return self._learned.choose(self._rng, name, options, drawn, near)

        biased, seed = self._campaign.closing.biased, self._rng.getrandbits(32)
        test = self._made_by_campaign("closing.biased", lambda: biased(choose, seed))
        origin = f"choices biased towards {goal[0]}: {goal[1]}"
        return Proposal(self._renamed(test, self._next_name(), origin), origin, goal, drawn)

    def _from_strategy(self, goal: Goal, drawn: list[Draw]) -> Proposal | None:
        while self._streams:
            name = self._learned.choose(self._rng, "strategy", [*self._streams], drawn)
            new = next(self._streams[name], None)
            if new is not None:
                return self._as_proposal(new, goal, drawn)
            del self._streams[name]
        return None

    def _as_proposal(self, test: Test, goal: Goal, drawn: Sequence[Draw]) -> Proposal:
        origin = f"{test.name} of {test.strategy}"
        return Proposal(self._renamed(test, self._next_name(), origin), origin, goal, drawn)

    def _nearest(self, goal: Goal) -> list[Played]:
        """The tests nearest to a goal, by `nearness`; ties are broken at random."""
        model, rng = self._goals.model, self._rng
        return heapq.nlargest(
            NEAREST,
            self._tests,
            lambda played: (nearness(goal, played.outcome.hits, model), rng.random()),
        )

    def _made_by_campaign(self, what: str, make: Callable[[], Test]) -> Test:
        """A test that a function of the campaign makes.

        Raises:
            TestError: the function fails, or returns something other than a test of the campaign.
        """
        with blamed(f"`{what}` of the campaign cannot make a test"):
            test: object = make()
        kind = self._campaign.test
        if not isinstance(test, kind):
            name = kind.__name__
            raise TestError(f"`{what}` of the campaign makes {test!r}, which is not a {name}")
        return test

    def _next_name(self) -> str:
        self._count += 1
        return f"{STRATEGY}-{self._count:03}"

    def _renamed(self, test: Test, name: str, origin: str) -> Test:
        named = structs.replace(test, name=name, strategy=STRATEGY, text=origin)
        kind = self._campaign.test
        try:
            return from_json(to_json(named), kind, source=f"test `{name}`, {origin}")
        except TestError as error:
            fix = f"; does `{kind.__name__}` take the strategy `{STRATEGY}`?"
            raise TestError(f"{error}{fix}") from None


def _stream(campaign: Campaign, strategy: str, robot: str, seed: int) -> Iterator[Test]:
    """The tests of a strategy for growing seeds, until a seed gives the same tests as the last."""
    before: Sequence[Test] = ()
    for number in count(seed):
        usable = [*_of_strategies(campaign, [strategy], robot, DRAWN, number)]
        if not usable or usable == before:
            return
        yield from usable
        before = usable


def _of_strategies(
    campaign: Campaign, strategies: Sequence[str], robot: str, tests: int, seed: int
) -> Iterator[Test]:
    """The tests of strategies that fit a robot and have no planted fault."""
    if not strategies:
        return
    by_strategy = plan(campaign, strategies, tests=tests, seed=seed).tests
    for test in chain.from_iterable(by_strategy.values()):
        if test.mutation is None and test.robot in (None, robot):
            yield test
