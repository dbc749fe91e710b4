"""Textbook models have their published answers."""

from pathlib import Path

import pytest
from tests.tools.timed_regions import shows

from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.budget import Policy
from rvmon.models.search.verify import verify

MODELS = Path(__file__).parents[4] / "examples" / "models"


def answers(network):
    """The answer to each query of a network, by id; each run is replayed."""
    found = {}
    for query in network.queries:
        outcome = verify(network, query)
        assert outcome.run is None or shows(network, outcome)
        found[query.id] = outcome.holds
    return found


def test_fischer_is_safe_and_stores_as_few_states_as_the_peer():
    stored = {}
    for processes in (2, 3, 4, 5):
        network = load_network(MODELS / "fischer.ta", constants={"N": processes})
        outcome = verify(network, network.queries[0])
        assert outcome.holds
        stored[processes] = outcome.statistics.stored
    assert (stored[4], stored[5]) == (220, 727)


def test_broken_fischer_is_refuted_by_a_run():
    """With >= instead of > two processes meet."""
    network = load_network(MODELS / "fischer_broken.ta", constants={"N": 2})
    outcome = verify(network, network.queries[0])
    assert outcome.holds is False
    assert shows(network, outcome)


@pytest.mark.slow
@pytest.mark.parametrize("trains", [2, 3, 4])
def test_trains_never_meet_and_always_cross(trains):
    network = load_network(MODELS / "train_gate.ta", constants={"N": trains})
    assert answers(network) == {"exclusion": True, "crossing": True, "alive": True}


def test_a_stopped_train_may_wait_for_ever_if_go_is_not_urgent():
    text = (MODELS / "train_gate.ta").read_text().replace("urgent chan", "chan")
    network = loads_network(text, constants={"N": 2})
    assert answers(network) == {"exclusion": True, "crossing": False, "alive": True}


@pytest.mark.slow
@pytest.mark.parametrize(("delays", "minutes"), [("5, 10, 20, 25", 60), ("1, 2, 5, 10", 17)])
def test_bridge_is_crossed_in_the_known_time(delays, minutes):
    text = (MODELS / "bridge.ta").read_text().replace("5, 10, 20, 25", delays)
    network = loads_network(text)
    over = verify(network, network.queries[0], policy=Policy.FASTEST)
    assert over.run is not None
    assert over.run.duration == minutes
    people = "forall (i : person) Person(i).safe"
    assert verify(network, f"E<>[<={minutes}] {people}").holds
    assert not verify(network, f"E<>[<={minutes - 1}] {people}").holds
