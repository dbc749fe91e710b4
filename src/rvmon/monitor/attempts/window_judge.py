"""Open attempts whose windows are followed by generated code, and by a network when need be.

The code tells when which attempt is decided. All else (what is owed and why, what may become of it,
snapshots, what is unknown) is told by the network that it stands for, which is told of the same
positions when somebody asks.
"""

from __future__ import annotations

from typing import Any

from rvmon.dataflow.chain import Windows
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import FOREVER, Network
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import WAITING, NetworkJudge, position_of
from rvmon.monitor.attempts.network_letters import Letters
from rvmon.runtime.values import NEVER


class WindowJudge(NetworkJudge):
    """Judges by generated code as long as nothing is unknown; then, until it rests, by networks."""

    def __init__(self, *args: Any, **kind: Any) -> None:
        self._network: Network | None = None
        self._windows: Windows | None = None
        super().__init__(*args, **kind)

    @property
    def worse(self) -> Network | None:  # type: ignore[override]
        """See `NetworkJudge`; while generated code judges, the network that it stands for."""
        journal = self._journals[0]
        if self._windows is None or journal is None:
            return self._network
        if not journal.is_at(self.now):
            journal.grow(None, self.now, self._first_waiting(better=False))
        return journal.after(len(journal))

    @worse.setter
    def worse(self, network: Network | None) -> None:
        self._network = network

    def _begin_network(self) -> None:
        if self._network is None and self._windows is None:
            self._letters = None
            self.sleeps = -NEVER

    def visit(self, t: int) -> None:
        """See `NetworkJudge`."""
        if self._windows is not None or (self._network is None and self._is_waited_for):
            letters = self._read(self.flow.values)
            if letters[0] == letters[1]:
                self._follow(t, letters)
                return
            self._fall_back()
        super().visit(t)

    def _follow(self, t: int, letters: Letters) -> None:
        if letters != self._letters or self.flow.gap is None:
            self._letters, letter = letters, letters[0]
            windows, journal = self._windows, self._journals[0]
            if windows is None or journal is None:
                made = self.compiled.windows
                if made is None:
                    raise AssertionError("such a requirement is judged by networks")
                windows = self._windows = made(letter)
                journal = self._journals[0] = Journal(Network(self.plan, self.flow.gap))
            elif journal.is_over:
                journal = self._renewed(windows, journal)
            journal.note(None, t, letter)
            windows.note(t // (self.flow.gap or 1), letter)
        self.position = t
        self._look(2 * t + 1)

    def _renewed(self, windows: Windows, journal: Journal) -> Journal:
        """A journal of what may still be asked for."""
        gap = self.flow.gap or 1
        start = windows.forget(self.position // gap)
        noted = journal.noted_since(start * gap)
        network = Network(self.plan, self.flow.gap)
        first = self._first_waiting(better=False)
        start = noted[0][0] // gap
        network.begin_at(start, start if first is None else min(first // gap, start), noted[0][1])
        self._journals[0] = journal = Journal(network, noted)
        return journal

    def _fall_back(self) -> None:
        """Have networks judge what is open."""
        if self._windows is None:
            super()._begin_network()
            return
        network = self.worse
        self._network, self._windows = network and network.copy(), None
        self._journals = [None, None]
        self._bounded_at = -FOREVER

    def _join(self, attempt: Open, t: int) -> None:
        if self._network is not None:
            super()._join(attempt, t)
        elif self._windows is not None:
            self._look(2 * t + 1)

    def _look(self, limit: int) -> None:
        windows, journal = self._windows, self._journals[0]
        if windows is None or journal is None:
            super()._look(limit)
            return
        self.now = limit
        gap, attempts = self.flow.gap or 1, self.attempts
        found = []
        due = NEVER
        parted = 0  # what the unknown leaves open comes before all that waits
        while attempts[parted].token[0] != WAITING:
            parted += 1
        for attempt in attempts[parted:] if parted else attempts:
            value, at = windows.outcome(position_of(attempt) // gap)
            if at > limit:
                due = at // 2
                break
            found.append((attempt, value, at // 2))
        if found:
            journal.grow(None, limit, position_of(found[0][0]))
            del attempts[parted : parted + len(found)]
            self._stood = None
            for attempt, value, t in found:
                self._decided(attempt, value, max(t, position_of(attempt)), attempt.token)
            if len(attempts) == parted:
                self._windows = self._letters = None
                self._journals = [None, None]
        self.due = due
        self.restless = self.flow.gap is None and self._windows is not None

    def _rest(self) -> None:
        if self._windows is None:
            super()._rest()

    def _wait(self, limit: int) -> None:
        if self._windows is None:
            super()._wait(limit)
        else:
            self._look(limit)

    @property
    def next_due(self) -> int:
        """See `NetworkJudge`."""
        return super().next_due if self._windows is None else self.due

    def situation(self, t: int) -> object:
        """See `NetworkJudge`."""
        if self._windows is not None:
            self._fall_back()
        return super().situation(t)

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """See `NetworkJudge`."""
        if self._windows is not None:
            self._fall_back()
        return super().held_at_end(attempt, end, reached)
