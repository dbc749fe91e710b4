"""A search that stops at its budget reports that it is undecided."""

import mmap
from pathlib import Path

import pytest
from tests.tools.timed_generate import random_model

from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.budget import Budget, Policy, Progress
from rvmon.models.search.verify import verify

MODEL = Path(__file__).parents[4] / "examples" / "models" / "train_gate.ta"


@pytest.mark.slow
@pytest.mark.parametrize(
    "query",
    ["A[] not Train(0).cross or not Train(1).cross", "Train(0).approach --> Train(0).cross",
     "A[] not deadlock", "Train(0).approach -->[<=1000] Train(0).cross"],
)  # fmt: skip
@pytest.mark.parametrize("budget", [Budget(states=100), Budget(seconds=0.0), Budget(megabytes=1)])
def test_a_search_that_exceeds_its_budget_is_undecided(query, budget):
    network = load_network(MODEL, constants={"N": 4})
    outcome = verify(network, query, budget=budget)
    assert outcome.holds is None
    assert outcome.run is None
    assert outcome.remark.startswith("not decided: ")


def test_a_run_found_within_the_budget_decides():
    network = load_network(MODEL, constants={"N": 4})
    assert verify(network, "E<> Train(3).cross", budget=Budget(states=200)).holds is True


@pytest.mark.slow
def test_the_watcher_gets_increasing_numbers_of_states():
    heard: list[Progress] = []
    network = load_network(MODEL, constants={"N": 5})
    verify(network, network.queries[0], watch=heard.append)
    assert len(heard) >= 2
    assert [p.visited for p in heard] == sorted(p.visited for p in heard)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 18, 40])
def test_no_budget_reverses_an_answer(seed):
    network = loads_network(random_model(seed))
    for query in network.queries:
        answer = verify(network, query).holds
        for states in (1, 2, 3, 5, 8, 13):
            assert verify(network, query, budget=Budget(states=states)).holds in (None, answer)


def test_a_reached_goal_counts_even_if_the_budget_ends_before_the_fastest_run():
    network = load_network(MODEL.with_name("bridge.ta"))
    query = network.queries[0]
    least = verify(network, query).statistics.visited
    outcome = verify(network, query, budget=Budget(states=least + 5), policy=Policy.FASTEST)
    assert (outcome.holds, outcome.policy) == (True, Policy.SHORTEST)
    assert outcome.remark.startswith("no fastest run was found: ")


def test_freed_memory_does_not_count_against_the_budget():
    large = [bytes(1 << 20) for _ in range(64)]
    held = sum(map(len, large)) >> 20
    del large
    network = load_network(MODEL, constants={"N": 3})
    now = _resident()
    outcome = verify(network, network.queries[0], budget=Budget(megabytes=now + held // 2))
    assert outcome.holds


def _resident() -> int:
    try:
        fields = Path("/proc/self/statm").read_text(encoding="ascii").split()
    except OSError:
        pytest.skip("the system does not tell what a process holds now")
    return int(fields[1]) * mmap.PAGESIZE >> 20
