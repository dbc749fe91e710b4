"""What generated code saw of signals and events."""

from __future__ import annotations

from rvmon.monitor.inputs.health import Arrivals
from rvmon.runtime.nodes import Nodes


def arrivals_of(nodes: Nodes) -> Arrivals:
    """What was seen by generated code."""
    names = nodes.SIGNALS
    expired = {names[signal]: found for signal, found in nodes.expired.items()}
    return Arrivals(nodes.absent, dict(zip(names, nodes.first, strict=True)), expired)
