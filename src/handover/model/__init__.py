"""The handover as a network of six timed automata, and what is asked of it."""

from handover.model.network import handover_network

__all__ = ["handover_network"]
