"""A suite covers every reachable item, with runs of the network."""

from pathlib import Path

import pytest
from tests.tools.each import each

from rvmon.models.language.load import load_network, loads_network
from rvmon.models.runs.exact_times import Rules
from rvmon.models.search.budget import Budget
from rvmon.models.search.suite import Criterion, all_items, build_suite, item_text

MODELS = Path(__file__).parents[4] / "examples" / "models"


def items_of(network, run, criterion):
    """The items that a run covers, computed from its steps."""
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
def test_the_runs_of_a_suite_cover_the_items_it_claims(model, criterion):
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


@each(
    ("criterion", "missing"),
    [
        (Criterion.LOCATIONS, ["A.c"]),
        (Criterion.EDGES, ["A: a → c", "A: c → b"]),
        # Pairs with an edge that is never enabled, and pairs whose times do not fit.
        (
            Criterion.EDGE_PAIRS,
            [
                "A: a → c, then c → b",
                "A: c → b, then b → d",
                "A: b → d, then d → a",
                "A: d → a, then a → c",
            ],
        ),
    ],
)
def test_the_missing_items_are_the_unreachable_ones(criterion, missing):
    network = loads_network("""
    clock x
    automaton A {
      location a invariant x <= 1
      location b
      location c
      location d
      start a
      edge a -> b
      edge a -> c when x > 1
      edge c -> b
      edge a -> d
      edge b -> d when x >= 2
      edge d -> a when x <= 1
    }
    """)
    suite = build_suite(network, criterion)
    assert [item_text(network, item, criterion) for item in suite.missing] == missing


def test_a_suite_stopped_by_its_budget_says_so():
    network = load_network(MODELS / "train_gate.ta", constants={"N": 4})
    suite = build_suite(network, Criterion.EDGES, budget=Budget(states=20))
    assert suite.stopped
    assert suite.missing
