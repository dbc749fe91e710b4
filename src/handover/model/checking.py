"""The model-checking column of the results: the seed's queries, decided on the network."""

from __future__ import annotations

from handover.model.network import handover_network

REQUIREMENTS = ("R1", "R2", "R3", "R4", "R5")


def model_checking() -> dict[str, bool | None]:
    """Whether each requirement's query holds; `None` where the network cannot express it.

    R5 speaks of the distance between hand and gripper, which the network does not have.

    >>> model_checking()
    {'R1': True, 'R2': True, 'R3': True, 'R4': True, 'R5': None}
    """
    from rvmon.timed.verify import verify

    network = handover_network()
    queries = {query.id: query for query in network.queries}
    return {
        name: verify(network, queries[name]).holds if name in queries else None
        for name in REQUIREMENTS
    }
