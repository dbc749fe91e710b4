"""What a network was given since it stood in some way, to see later how it stood in between."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from operator import itemgetter

from rvmon.dataflow.network import Network
from rvmon.dataflow.piecewise import FAR

_LEAST = 64
"""A journal has at least so many entries before another one is begun."""


class Journal:
    """A network as it stood, and what it was given from then on.

    What it holds on to is a network without what had been dropped by then, and as many entries.

    Args:
        network: as it stands.
        noted: the positions that it is to be given next.
    """

    def __init__(self, network: Network, noted: Sequence[tuple[int, Sequence[bool]]] = ()) -> None:
        self._plan, self._gap = network.plan, network.positions.distance
        # Most networks live for an attempt alone.
        self._begun = None if network.grown == -FAR and not network.noted else network.copy()
        self._entries: list[tuple[int, Sequence[bool] | None, int | None]] = [
            (t, letter, None) for t, letter in noted
        ]
        size = sum(len(true) + len(false) for true, false in network.known)
        self._most = max(_LEAST, size + len(network.noted), 2 * len(noted))
        self._telling = False
        self._played: tuple[int, Network] | None = None

    def __len__(self) -> int:
        """The number of entries."""
        return len(self._entries)

    @property
    def is_over(self) -> bool:
        """Whether it is time for another one: it is full, or the network was interrupted."""
        return self._telling or len(self._entries) >= self._most

    def is_at(self, limit: int) -> bool:
        """Whether the last entry was that time came to a stamp."""
        return (
            bool(self._entries) and self._entries[-1][0] == limit and self._entries[-1][1] is None
        )

    def noted_since(self, t: int) -> list[tuple[int, Sequence[bool]]]:
        """The positions that it was given, from `t` on, at which the letter stood as well."""
        noted = [(at, letter) for at, letter, _ in self._entries if letter is not None]
        count = max(bisect_right(noted, t, key=itemgetter(0)), 1)
        at, letter = noted[count - 1]
        return [(max(t, at), letter), *noted[count:]]

    def note(self, network: Network | None, t: int, letter: Sequence[bool]) -> None:
        """Tell the network of a position, if there is one by now; see `Network.note`."""
        self._telling = True
        if network is not None:
            network.note(t, letter)
        self._entries.append((t, letter, None))
        self._telling = False

    def grow(self, network: Network | None, limit: int, wanted: int | None = None) -> None:
        """Tell the network of time, if there is one by now; see `Network.grow`."""
        self._telling = True
        if network is not None:
            network.grow(limit, wanted)
        self._entries.append((limit, None, wanted))
        self._telling = False

    def after(self, count: int) -> Network:
        """The network as it stood after so many entries; it is not to be given anything."""
        done, network = self._played or (0, None)
        if network is None or done > count:
            begun = self._begun
            done, network = 0, begun.copy() if begun else Network(self._plan, self._gap)
        for at, letter, wanted in self._entries[done:count]:
            if letter is None:
                network.grow(at, wanted)
            else:
                network.note(at, letter)
        self._played = count, network
        return network
