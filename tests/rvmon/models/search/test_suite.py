"""Suites go through everything that can be gone through, with runs that are runs."""

from pathlib import Path

import pytest

from rvmon.errors import ModelError
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.runs.exact_times import Rules
from rvmon.models.search.budget import Budget
from rvmon.models.search.suite import Criterion, all_items, build_suite, item_text

MODELS = Path(__file__).parents[4] / "examples" / "models"


def items_of(network, run, criterion):
    """The items that a run goes through, read off the run itself."""
    places = {(i, place) for i, place in enumerate(run.start.locations)}
    edges, pairs, last = set(), set(), {}
    for step in run.steps:
        places |= set(enumerate(step.position.locations))
        for automaton, edge in step.action.edges:
            number = network.automata[automaton].edges.index(edge)
            edges.add((automaton, number))
            if automaton in last:
                pairs.add((automaton, last[automaton], number))
            last[automaton] = number
    return {"locations": places, "edges": edges, "edge-pairs": pairs}[criterion]


@pytest.mark.slow
@pytest.mark.parametrize("criterion", list(Criterion))
@pytest.mark.parametrize("model", ["fischer", "train_gate", "bridge"])
def test_what_is_said_to_be_covered_is(model, criterion):
    constants = {} if model == "bridge" else {"N": 2}
    network = load_network(MODELS / f"{model}.ta", constants=constants)
    suite = build_suite(network, criterion)
    seen = set()
    for run, items in suite.runs:
        Rules(network).replay(run)
        here = items_of(network, run, criterion)
        assert {(item.automaton, *item.numbers) for item in items} <= here
        seen |= here
    assert len(seen) == suite.covered
    assert suite.covered + len(suite.missing) == len(list(all_items(network, criterion)))
    assert len(suite.runs) < suite.covered


def test_missing_items_are_those_that_cannot_be_reached():
    network = loads_network("""
    clock x
    automaton A {
      location a invariant x <= 1
      location b
      location c
      start a
      edge a -> b
      edge a -> c when x > 1
      edge c -> b
    }
    """)
    edges = build_suite(network, Criterion.EDGES)
    assert [item_text(network, item, Criterion.EDGES) for item in edges.missing] == [
        "A: a → c",
        "A: c → b",
    ]
    places = build_suite(network, Criterion.LOCATIONS)
    assert [item_text(network, item, Criterion.LOCATIONS) for item in places.missing] == ["A.c"]


def test_pairs_that_time_forbids_are_missing():
    network = loads_network("""
    clock x
    automaton A {
      location a
      start a
      edge a -> a when x >= 2
      edge a -> a when x <= 1
    }
    """)
    suite = build_suite(network, Criterion.EDGE_PAIRS)
    assert [item.numbers for item in suite.missing] == [(0, 1)]


def test_a_network_that_cannot_start_has_no_suite():
    network = loads_network(
        "int[0,1] v = 1 automaton A { location a invariant v == 0 start a edge a -> a }"
    )
    with pytest.raises(ModelError, match="of the initial locations is false at time 0"):
        build_suite(network, Criterion.EDGES)


def test_a_budget_is_told():
    network = load_network(MODELS / "train_gate.ta", constants={"N": 4})
    suite = build_suite(network, Criterion.EDGES, budget=Budget(states=20))
    assert suite.stopped
    assert suite.missing
