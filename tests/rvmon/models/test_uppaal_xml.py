"""A network written as UPPAAL XML and read back is the same; drawings are complete."""

from pathlib import Path

import pytest
from tests.tools.timed_generate import random_model

from handover.model import handover_network
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.suite import Criterion, build_suite
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import network_dot, uppaal_xml

MODELS = Path(__file__).parents[3] / "examples" / "models"


@pytest.mark.law
def test_random_networks_survive_the_round_trip():
    for seed in range(40):
        network = loads_network(random_model(2 * seed))
        again = loads_network(uppaal_xml(network))
        assert again.automata == network.automata
        assert again.variables == network.variables
        assert again.channels == network.channels
        assert again.priorities == network.priorities
        beyond = ("[<=", "EF ", "AG ", "AF ")
        plain = [q for q in network.queries if not any(part in q.text for part in beyond)]
        assert len(plain) == 7
        assert [q.formula for q in again.queries] == [q.formula for q in plain]


@pytest.mark.slow
@pytest.mark.parametrize("model", ["fischer.ta", "train_gate.xml", "bridge.xml", "csma_cd.xml"])
def test_flattened_templates_and_arrays_have_the_same_answers(model):
    constants = {} if model == "bridge.xml" else {"N": 2}
    network = load_network(MODELS / model, constants=constants)
    again = loads_network(uppaal_xml(network))
    assert [len(a.edges) for a in again.automata] == [len(a.edges) for a in network.automata]
    for query, same in zip(network.queries, again.queries, strict=True):
        assert verify(again, same).holds == verify(network, query).holds
    there, here = (build_suite(n, Criterion.EDGES) for n in (again, network))
    assert there.missing == here.missing
    assert there.statistics.visited == here.statistics.visited


@pytest.mark.slow
def test_the_handover_network_keeps_unit_weights_and_labels():
    """Comments keep what UPPAAL cannot express, such as the text of its unsupported queries."""
    network = handover_network()
    xml = uppaal_xml(network)
    again = loads_network(xml)
    assert again.unit == network.unit
    assert again.automata == network.automata
    assert (again.name, again.title) == (network.name, network.title)
    assert "not a query of UPPAAL: robot.recv2 --&gt;[&lt;=600]" in " ".join(xml.split())
    told = {(query.id, query.remark) for query in network.queries}
    assert {(query.id, query.remark) for query in again.queries} <= told
    assert "R1" in {query.id for query in again.queries}


def test_names_become_unique_identifiers():
    network = loads_network("""
    clock process
    int[0,1] T_1_v
    automaton T(const int[1,2] i) {
      int[0,1] v
      location init
      start init
      edge init -> init when process >= 1 do v = 1, T_1_v = 1
    }
    query: E<> T(1).v == 1 and T_1_v == 1
    """)
    again = loads_network(uppaal_xml(network))
    assert len({v.name for v in again.variables}) == 3
    assert verify(again, again.queries[0]).holds


def test_the_drawing_has_every_location_and_edge():
    network = handover_network()
    dot = network_dot(network)
    assert dot.count(" -> ") == sum(len(a.edges) for a in network.automata)
    assert dot.count("subgraph") == 6
    assert '"U send"' in dot
    assert '"C reading"' in dot
    assert "weight 0.05" in dot
