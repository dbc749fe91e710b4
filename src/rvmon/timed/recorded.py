"""Recordings as the actions that a network knows."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.timed.conformance import Recorded
from rvmon.timed.model import Network
from rvmon.trace.sample import Sample


def labels_of(network: Network) -> tuple[str, ...]:
    """All names that the actions of a network may have in recordings, in order of appearance."""
    names = dict.fromkeys(
        name
        for automaton in network.automata
        for edge in automaton.edges
        for name in (edge.label, _channel_name(network, edge.sync.slot.first) if edge.sync else "")
    )
    return tuple(name for name in names if name)


def _channel_name(network: Network, first: int) -> str:
    return network.channels[first].name


def actions_in(
    samples: Iterable[Sample], labels: frozenset[str]
) -> tuple[list[Recorded], int, frozenset[str]]:
    """The actions of a recording that have one of some labels.

    Returns:
        The actions with their ticks since the first sample; the ticks from the first to the last
        sample; the labels that occurred.
    """
    actions: list[Recorded] = []
    first = last = None
    for sample in samples:
        first = sample.t if first is None else first
        last = sample.t
        actions += [
            Recorded(sample.t - first, name)
            for name, value in sample.values.items()
            if name in labels and value is not None and value is not False
        ]
    length = 0 if first is None or last is None else last - first
    return actions, length, frozenset(action.label for action in actions)
