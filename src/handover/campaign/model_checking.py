"""What model checking says of the requirements that the handover's model can express."""

from __future__ import annotations

from functools import cache


@cache
def check_model(requirements: tuple[str, ...]) -> dict[str, bool | None]:
    """Ask the model checker for a run that shows each requirement, as the paper did.

    Args:
        requirements: ids; one that the model has no query for cannot be expressed: `None`.
    """
    from handover.model import handover_network
    from rvmon.timed.search.verify import verify

    network = handover_network()
    queries = {query.id: query for query in network.queries}
    return {
        name: verify(network, queries[name]).holds if name in queries else None
        for name in requirements
    }
