"""The goals of closing with their hits so far, and the model's witnesses or proofs for them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING

from msgspec.structs import replace

from rvmon.cdv.campaign import ClosingModel
from rvmon.cdv.template import Template, project
from rvmon.coverage import (
    STATES,
    Group,
    Hit,
    Hits,
    Item,
    Model,
    Subject,
    group_of,
    merged,
    share,
    without,
)
from rvmon.coverage.holes import Goal, Hole, hole_of, nearest_tests
from rvmon.language.checked.properties import BinKind

if TYPE_CHECKING:
    from rvmon.cdv.test import Test
    from rvmon.models.network import Edge, Network
    from rvmon.models.runs import Run
    from rvmon.models.search.suite import Suite


class Goals:
    """The goals of a coverage model, and how often they were hit.

    Args:
        model: the coverage model.
        argued: items that are declared unreachable, each with the reason.
    """

    def __init__(self, model: Model, argued: Mapping[Goal, str]) -> None:
        self.model = model
        # The number of hits that each item needs.
        self.wanted: dict[Goal, int] = {
            (group.name, item.name): item.goal
            for group in model.groups.values()
            if group.weight
            for item in group.items.values()
            if item.kind is BinKind.GOAL
        }
        self.argued = {goal: why for goal, why in argued.items() if goal in self.wanted}
        # Items that are proved unreachable, each with the query that proves it.
        self.proved: dict[Goal, str] = {}
        # Unreachable items that were hit nevertheless, each with the first test that hit it.
        self.wrong: dict[Goal, str] = {}
        self._seen: list[tuple[str, Hits]] = []
        self._counts: dict[Goal, int] = {}

    @property
    def sought(self) -> dict[Goal, int]:
        """The number of hits needed, by item; without unreachable items."""
        return {
            goal: count for goal, count in self.wanted.items() if not self._is_unreachable(goal)
        }

    @property
    def open(self) -> list[Goal]:
        """The items with fewer hits than they need, in the model's order."""
        return [goal for goal in self.sought if not self.is_met(goal)]

    @property
    def met(self) -> int:
        """The number of items that are met."""
        return sum(map(self.is_met, self.sought))

    def is_met(self, goal: Goal) -> bool:
        """Whether an item has all the hits that it needs."""
        return self._counts.get(goal, 0) >= self.wanted[goal]

    @property
    def share(self) -> float:
        """The covered share of the model without its unreachable items, from 0 to 1."""
        hits = merged(hits_of_test for _, hits_of_test in self._seen)
        return share(hits, without(self.model, [*self.proved, *self.argued]))

    def holes(self) -> dict[Goal, Hole]:
        """The open items, each with a description of what is missing."""
        hits = merged(hits_of_test for _, hits_of_test in self._seen)
        nearest = nearest_tests(self.open, self._seen, self.model)
        return {goal: hole_of(goal, self.model, hits, nearest.get(goal, "")) for goal in self.open}

    def _is_unreachable(self, goal: Goal) -> bool:
        """Whether an item is proved or declared unreachable."""
        return goal in self.proved or goal in self.argued

    def add(self, test: str, hits: Hits) -> list[Goal]:
        """Count the hits of a test, and return the goals that it is the first to meet."""
        added = []
        self._seen.append((test, hits))
        for group, items in hits.items():
            for item, hit in items.items():
                goal = group, item
                if goal not in self.wanted:
                    continue
                before = self.is_met(goal)
                self._counts[goal] = self._counts.get(goal, 0) + hit.count
                if self._is_unreachable(goal):
                    self.wrong.setdefault(goal, test)
                elif self.is_met(goal) and not before:
                    added.append(goal)
        return added


EDGES = "edges of the model"
"""The group of the model's edges, which tests show when they follow a run of the model."""

MOST_STATES = 200_000
"""The most symbolic states explored for a query; if they do not decide it, its item stays open."""


@dataclass(frozen=True, slots=True)
class Witness:
    """A run of the model that should hit an item."""

    run: Run
    query: str


@dataclass(frozen=True, slots=True)
class Proof:
    """The proof that no run of the model hits an item."""

    query: str


class Witnesses:
    """Asks a model for witnesses of goals; each query is asked once.

    Args:
        model: the model.
        describes: whether the model describes the robot under test. If not, it proves nothing, and
            its edges are not goals.
    """

    def __init__(self, model: ClosingModel, *, describes: bool) -> None:
        self._model = model
        self._describes = describes
        self._answers: dict[str, Witness | Proof | None] = {}
        self._divergences: dict[Goal, tuple[str, str]] = {}

    @cached_property
    def _network(self) -> Network:
        return self._model.network()

    @cached_property
    def _suite(self) -> Suite:
        from rvmon.models.search.budget import Budget
        from rvmon.models.search.suite import Criterion, build_suite

        return build_suite(self._network, Criterion.EDGES, budget=Budget(states=MOST_STATES))

    @cached_property
    def _names(self) -> dict[tuple[int, Edge], str]:
        """The name of each edge, by the index of its automaton; equal names are numbered."""
        names: dict[tuple[int, Edge], str] = {}
        seen: Counter[str] = Counter()
        for index, automaton in enumerate(self._network.automata):
            for edge in automaton.edges:
                text = f"{automaton.name}: {edge.text}"
                seen[text] += 1
                names[index, edge] = f"{text} ({seen[text]})" if seen[text] > 1 else text
        return names

    @property
    def groups(self) -> list[Group]:
        """The edges of the model as a group of goals; empty if it does not describe the robot."""
        if not self._describes:
            return []
        return [group_of(EDGES, Subject.TRANSITIONS, [*map(Item, self._names.values())])]

    def knows(self, goal: Goal) -> bool:
        """Whether the model can be asked about an item."""
        return goal[0] == EDGES or bool(self._model.query(*goal))

    def answer(self, goal: Goal) -> Witness | Proof | None:
        """A run that should hit an item, a proof that there is none, or `None` if undecided.

        Raises:
            ModelError: the campaign's query for the item is not a valid query of the model.
        """
        query = self._model.query(*goal)
        if not query and goal[0] == EDGES:
            return self._edge_answer(goal[1])
        if query and query not in self._answers:
            self._answers[query] = self._verify(query)
        return self._answers.get(query)

    def test(self, witness: Witness, name: str, seed: int) -> Test:
        """A test that acts as the automata controlled by tests do in the run.

        Raises:
            TestError: no times in whole units satisfy the limits of the run.
        """
        model, network = self._model, self._network
        steps, limits = project(network, witness.run, model.automata, model.actions)
        unit_s = (network.unit or 0) / 1e9
        template = Template(name, "", witness.query, "shortest", unit_s, steps, limits)
        return model.make(template, seed)

    def shown(self, witness: Witness, test: str, hits: Hits) -> dict[str, dict[str, Hit]]:
        """The edges of the model that a test has shown.

        These are all edges of the run if the system first entered the states of the run in the same
        order, otherwise none; the difference is noted for `explained`.
        """
        if not self._describes:
            return {}
        edges = [self._names[taken] for taken in _edges_of(witness.run)]
        visited = hits.get(STATES, {})
        # Only first entries are compared, as a system may re-enter a state, for example to poll.
        went = sorted(visited, key=lambda state: visited[state].first or 0)
        for came, planned in zip_longest(went, self._states_of(witness.run)):
            if planned is not None and came != planned:
                entered = "no further state" if came is None else f"`{came}`"
                why = f"a test of a run that takes it enters {entered} where the run enters "
                for edge in edges:
                    self._divergences.setdefault((EDGES, edge), (f"{why}`{planned}`", test))
                return {}
        return {EDGES: dict.fromkeys(edges, Hit(1))}

    def explained(self, holes: Mapping[Goal, Hole]) -> dict[Goal, Hole]:
        """Holes, where those of edges tell how the first test for the edge left its run."""
        needs = "a `make` that behaves like the run, or a model that behaves like the system"
        return {
            goal: replace(hole, why=why, needs=needs, nearest=test) if test else hole
            for goal, hole in holes.items()
            for why, test in [self._divergences.get(goal, ("", ""))]
        }

    def _states_of(self, run: Run) -> list[str]:
        """The states of the system in a run, in the order of their first entry."""
        names = [automaton.name for automaton in self._network.automata]
        robot = names.index(self._model.automaton)
        places = self._network.automata[robot].locations
        passed = [run.start, *(step.position for step in run.steps)]
        visited = (places[position.locations[robot]].name for position in passed)
        states = map(self._model.states.get, visited)
        return [*dict.fromkeys(state for state in states if state is not None)]

    def _edge_answer(self, name: str) -> Witness | Proof | None:
        """A run that takes an edge, from a suite that covers all reachable edges."""
        suite = self._suite
        for run, _ in suite.runs:
            if any(self._names[taken] == name for taken in _edges_of(run)):
                return Witness(run, f"the edge {name}")
        return None if suite.stopped else Proof(f"the edge {name}")

    def _verify(self, query: str) -> Witness | Proof | None:
        from rvmon.models.search.budget import Budget
        from rvmon.models.search.verify import verify

        outcome = verify(self._network, query, budget=Budget(states=MOST_STATES))
        if outcome.run is not None:
            return Witness(outcome.run, query)
        return Proof(query) if outcome.holds is not None and self._describes else None


def _edges_of(run: Run) -> Iterator[tuple[int, Edge]]:
    """The edges that a run takes, each with the index of its automaton."""
    for step in run.steps:
        yield from () if step.action is None else step.action.edges
