"""A search stops at its budget and says that it has not decided."""

from pathlib import Path

import pytest

from rvmon.timed.load import load_network
from rvmon.timed.search import Budget, Progress
from rvmon.timed.verify import verify

MODEL = Path(__file__).parents[3] / "examples" / "models" / "train_gate.ta"


@pytest.mark.parametrize(
    "query",
    ["A[] not Train(0).cross or not Train(1).cross", "Train(0).approach --> Train(0).cross",
     "A[] not deadlock", "Train(0).approach -->[<=1000] Train(0).cross"],
)  # fmt: skip
@pytest.mark.parametrize("budget", [Budget(states=100), Budget(seconds=0.0), Budget(megabytes=1)])
def test_not_decided_is_said(query, budget):
    """Whatever the limit and the kind of search, the answer is none and the reason is given."""
    network = load_network(MODEL, constants={"N": 4})
    outcome = verify(network, query, budget=budget)
    assert outcome.holds is None
    assert outcome.run is None
    assert outcome.remark.startswith("not decided: ")


def test_a_run_found_in_time_decides():
    """A budget that is not used up changes nothing."""
    network = load_network(MODEL, constants={"N": 4})
    assert verify(network, "E<> Train(3).cross", budget=Budget(states=200)).holds is True


def test_progress_is_told():
    """The watcher hears of more and more states."""
    heard: list[Progress] = []
    network = load_network(MODEL, constants={"N": 5})
    verify(network, network.queries[0], watch=heard.append)
    assert len(heard) >= 2
    assert [p.visited for p in heard] == sorted(p.visited for p in heard)
