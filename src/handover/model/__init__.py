"""The handover as a network of six timed automata, with its queries."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rvmon.models.network import Network


__all__ = ["handover_network"]


MODEL_FILE = "handover.ta"


@cache
def handover_network() -> Network:
    """Read the network of robot, workflow, gaze, location, pressure and sensors."""
    from rvmon.models.language.load import loads_network

    text = resources.files("handover.model").joinpath(MODEL_FILE).read_text(encoding="utf-8")
    return loads_network(text, name=MODEL_FILE)
