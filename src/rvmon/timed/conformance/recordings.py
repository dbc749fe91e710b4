"""Recordings as the actions that a network knows, and runs of it as recordings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from rvmon.timed.model.evaluate import Evaluator
from rvmon.timed.model.network import Network
from rvmon.timed.runs.run import Action, Position, Run
from rvmon.trace.sample import Sample


@dataclass(frozen=True, slots=True)
class Recorded:
    """An action of a recording: its label, and its instant in ticks since the start."""

    t: int
    label: str


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


def recording_of(
    network: Network, run: Run, signals: Mapping[str, Evaluator]
) -> tuple[list[Sample], int]:
    """A run as it would be recorded: its signals at each action, the actions' labels as events.

    Args:
        network: with a unit of time.
        run: of the network.
        signals: how each is read off locations and variables.

    Returns:
        The samples, actions at one instant in one of them; the instant at which the run ends.
    """

    def read(position: Position) -> dict[str, int]:
        return {n: value(position.locations, position.values) for n, value in signals.items()}

    unit, now = network.unit or 1, Fraction(0)
    samples: dict[int, dict[str, int | bool]] = {0: {**read(run.start)}}
    for step in run.steps:
        now += step.delay
        if step.action is not None:
            at = samples.setdefault(round(now * unit), {})
            at.update(read(step.position) | dict.fromkeys(_names(network, step.action), True))
    return [Sample(t, values) for t, values in samples.items()], round(now * unit)


def _names(network: Network, action: Action) -> list[str]:
    sync = action.edges[0][1].sync
    channel = _channel_name(network, sync.slot.first) if sync is not None else ""
    return [name for name in (*(edge.label for _, edge in action.edges), channel) if name]
