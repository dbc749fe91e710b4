"""Tests from runs of the campaign's model, and proofs that there is none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from rvmon.cdv.campaign import ClosingModel
from rvmon.cdv.template import Template, project
from rvmon.coverage.holes import Goal
from rvmon.coverage.model import STATES, Group, Hit, Hits, Item, Subject, group_of

if TYPE_CHECKING:
    from rvmon.cdv.test import Test
    from rvmon.timed.model.network import Edge, Network
    from rvmon.timed.runs.run import Run
    from rvmon.timed.search.suite import Suite

EDGES = "edges of the model"
"""The group of what tests show of the model."""

MOST_STATES = 200_000
"""Symbolic states within which a query is to be decided, else its item stays open."""


@dataclass(frozen=True, slots=True)
class Witness:
    """A run of the model that is to hit an item.

    Attributes:
        run: of the model.
        query: that it is a witness of.
    """

    run: Run
    query: str


@dataclass(frozen=True, slots=True)
class Proof:
    """That no run of the model hits an item.

    Attributes:
        query: whose answer says so.
    """

    query: str


class Witnesses:
    """Asks a model about goals, each once.

    Args:
        model: with its network.
        describes: whether it describes the robot that is tested: else it proves nothing, and there
            are no edges to be shown.
    """

    def __init__(self, model: ClosingModel, *, describes: bool) -> None:
        self._model = model
        self._describes = describes
        self._answers: dict[str, Witness | Proof | None] = {}

    @cached_property
    def _network(self) -> Network:
        return self._model.network()

    @cached_property
    def _suite(self) -> Suite:
        from rvmon.timed.search.outcome import Budget
        from rvmon.timed.search.suite import Criterion, build_suite

        return build_suite(self._network, Criterion.EDGES, budget=Budget(states=MOST_STATES))

    @cached_property
    def _names(self) -> dict[tuple[int, Edge], str]:
        """All edges by automaton; those that look the same are numbered."""
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
        """The edges of the model, as what there is to be covered."""
        if not self._describes:
            return []
        return [group_of(EDGES, Subject.TRANSITIONS, [*map(Item, self._names.values())])]

    def knows(self, goal: Goal) -> bool:
        """Whether the model can be asked about an item."""
        return goal[0] == EDGES or bool(self._model.query(*goal))

    def answer(self, goal: Goal) -> Witness | Proof | None:
        """A run that is to hit an item, the proof that there is none, or nothing.

        Raises:
            ModelError: what the campaign asks about the item is no query of the model.
        """
        query = self._model.query(*goal)
        if not query and goal[0] == EDGES:
            return self._on_edge(goal[1])
        if query and query not in self._answers:
            self._answers[query] = self._asked(query)
        return self._answers.get(query)

    def test(self, witness: Witness, name: str, seed: int) -> Test:
        """A test that does what the run's automata do that tests stand for.

        Raises:
            TestError: no whole numbers of units satisfy the limits of the run.
        """
        model, network = self._model, self._network
        steps, limits = project(network, witness.run, model.automata, model.actions)
        unit_s = (network.unit or 0) / 1e9
        template = Template(name, "", witness.query, "shortest", unit_s, steps, limits)
        return model.make(template, seed)

    def shown(self, witness: Witness, hits: Hits) -> dict[str, dict[str, Hit]]:
        """The edges of the model that the test of a run has shown."""
        if not self._describes:
            return {}
        visited = hits.get(STATES, {})
        went = sorted(visited, key=lambda state: visited[state].first or 0)
        planned = self._course(witness.run)
        if went[: len(planned)] != planned:
            return {}
        return {EDGES: {self._names[taken]: Hit(1) for taken in _edges_of(witness.run)}}

    def _course(self, run: Run) -> list[str]:
        """The states of the system in a run, in the order of their first entry."""
        names = [automaton.name for automaton in self._network.automata]
        robot = names.index(self._model.automaton)
        places = self._network.automata[robot].locations
        passed = [run.start, *(step.position for step in run.steps)]
        states = (self._model.states.get(places[one.locations[robot]].name) for one in passed)
        return [*dict.fromkeys(state for state in states if state is not None)]

    def _on_edge(self, name: str) -> Witness | Proof | None:
        """The first run of a suite that takes an edge."""
        suite = self._suite
        for run, _ in suite.runs:
            if any(self._names[taken] == name for taken in _edges_of(run)):
                return Witness(run, f"the edge {name}")
        return None if suite.stopped else Proof(f"the edge {name}")

    def _asked(self, query: str) -> Witness | Proof | None:
        from rvmon.timed.search.outcome import Budget
        from rvmon.timed.search.verify import verify

        outcome = verify(self._network, query, budget=Budget(states=MOST_STATES))
        if outcome.run is not None:
            return Witness(outcome.run, query)
        return Proof(query) if outcome.holds is not None and self._describes else None


def _edges_of(run: Run) -> Iterator[tuple[int, Edge]]:
    """The edges that a run takes, each with the number of its automaton."""
    for step in run.steps:
        yield from () if step.action is None else step.action.edges
