"""The handover network: the seed's queries, claims about all runs, and inexpressible ones."""

import pytest
from tests.tools.timed_regions import shows

from handover.model import handover_network
from rvmon.errors import ModelError
from rvmon.models.search.verify import verify


@pytest.fixture(scope="module")
def network():
    return handover_network()


def test_it_is_six_automata(network):
    names = [automaton.name for automaton in network.automata]
    assert names == ["robot", "workflow", "gaze", "location", "pressure", "sensors"]
    assert network.warnings == ()


@pytest.mark.parametrize("requirement", ["R1", "R2", "R3", "R4"])
def test_the_seeds_queries_hold(network, requirement):
    """R1 to R4 have a witness, which is a run with the intended behaviour."""
    (query,) = (q for q in network.queries if q.id == requirement)
    outcome = verify(network, query)
    assert outcome.holds
    assert shows(network, outcome)


@pytest.mark.slow
@pytest.mark.parametrize("claim", ["R2_all", "R4_all", "sound"])
def test_claims_on_all_runs_hold(network, claim):
    """No run releases after a bad reading, continues for ever, or gets stuck."""
    (query,) = (q for q in network.queries if q.id == claim)
    assert verify(network, query).holds


@pytest.mark.slow
def test_release_comes_within_ten_units_and_no_less(network):
    (query,) = (q for q in network.queries if q.id == "R1_all")
    tight = query.text.replace("60", "10")
    assert verify(network, tight).holds
    outcome = verify(network, query.text.replace("60", "9"))
    assert outcome.holds is False
    assert shows(network, outcome)


@pytest.mark.slow
def test_the_hands_distance_is_not_expressible(network):
    """R5 speaks of a distance in space, which the network does not have."""
    with pytest.raises(ModelError, match="no name `hand_distance`"):
        verify(network, "A[] (hand_distance >= 5)")
