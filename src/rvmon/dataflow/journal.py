"""What a network was told since it stood in some way, to see later how it stood in between."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.network import Network
from rvmon.dataflow.piecewise import FAR

_LEAST = 64
"""A journal has at least so many entries before another one is begun."""


class Journal:
    """A network as it stood, and what it was told from then on.

    What it holds on to is a network without what had been dropped by then, and as many entries.

    Args:
        network: as it stands.
    """

    def __init__(self, network: Network) -> None:
        self._plan, self._gap = network.plan, network.positions.distance
        # Most networks live for an attempt alone.
        self._begun = None if network.grown == -FAR and not network.noted else network.copy()
        self._told: list[tuple[int, Sequence[bool] | None, int | None]] = []
        size = sum(len(true) + len(false) for true, false in network.known)
        self._most = max(_LEAST, size + len(network.noted))
        self._telling = False
        self._played: tuple[int, Network] | None = None

    def __len__(self) -> int:
        """The number of entries."""
        return len(self._told)

    @property
    def is_over(self) -> bool:
        """Whether it is time for another one: it is full, or the network was interrupted."""
        return self._telling or len(self._told) >= self._most

    def note(self, network: Network, t: int, letter: Sequence[bool]) -> None:
        """Tell the network of a position; see `Network.note`."""
        network.note(t, letter)
        self._told.append((t, letter, None))

    def grow(self, network: Network, limit: int, wanted: int | None = None) -> None:
        """Tell the network of time; see `Network.grow`."""
        self._telling = True
        network.grow(limit, wanted)
        self._told.append((limit, None, wanted))
        self._telling = False

    def after(self, count: int) -> Network:
        """The network as it stood after so many entries; it is not to be told anything."""
        done, network = self._played or (0, None)
        if network is None or done > count:
            begun = self._begun
            done, network = 0, begun.copy() if begun else Network(self._plan, self._gap)
        for at, letter, wanted in self._told[done:count]:
            if letter is None:
                network.grow(at, wanted)
            else:
                network.note(at, letter)
        self._played = count, network
        return network
