"""Open attempts whose windows are followed by generated code, and by a network when need be.

The code finds when which attempt is decided. All else (what is owed and why, what may become of it,
snapshots, what is unknown) comes from the network that it stands for, which is given the same
positions when somebody asks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

from rvmon.dataflow.chain import Windows
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import Network
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.attempts.network_letters import Clear, Letters, Noted, journal_of
from rvmon.monitor.attempts.waiting import position_of
from rvmon.monitor.explained.network import WAITING
from rvmon.runtime.values import NEVER


class WindowJudge(NetworkJudge):
    """Judges by generated code; where something is unknown, by networks for a while.

    Args:
        windows: the class of that code.
        *args: as for `NetworkJudge`.
        **kind: the same.
    """

    def __init__(self, windows: type[Windows], *args: Any, **kind: Any) -> None:
        self._made = windows
        self._network: Network | None = None
        self._windows: Windows | None = None
        self._torn = False
        """Whether the code is at work; else, if an interrupt left it with a part of a position."""
        super().__init__(*args, **kind)
        self._clear = Clear(self.compiled.reach, self.flow.gap)

    @property
    def worse(self) -> Network | None:
        """See `NetworkJudge`; while generated code judges, the network that it stands for."""
        journal = self._journals[0]
        if self._windows is None or journal is None:
            return self._network
        if not (self._torn or journal.is_at(self.now)):
            journal.grow(None, self.now, self._first_waiting(better=False))
        return journal.after(len(journal))

    @worse.setter
    def worse(self, network: Network | None) -> None:
        self._network = network

    def _begin_network(self) -> None:
        if self._torn:
            self._recover()
        if self._network is None and self._windows is None:
            self._letters = None
            self.sleeps = -NEVER

    def visit(self, t: int) -> None:
        """See `NetworkJudge`."""
        if self._torn:
            self._recover()
        letters = self._read(self.flow.values)
        if self._windows is None and not (self._network is None and self._is_waited_for):
            self._visit_networks(t, letters)
            if self._network is not None and self._clear.is_over(t):
                self._use_windows(t)
        elif letters[0] == letters[1]:
            self._follow(t, letters)
        else:
            self._fall_back()
            self._visit_networks(t, letters)

    def _visit_networks(self, t: int, letters: Letters) -> None:
        if self._network is not None:
            self._clear.note(t, letters)
        super().visit(t)

    def _follow(self, t: int, letters: Letters) -> None:
        windows, journal, same = self._windows, self._journals[0], letters is self._letters
        self.position = t
        if not same or self.flow.gap is None:
            self._torn, letter = True, letters[0]
            if windows is None or journal is None:
                self._begin_windows([(t, letter)])
            else:
                if journal.is_over:
                    gap = self.flow.gap or 1
                    journal = self._journal_of(journal.noted_since(windows.forget(t // gap) * gap))
                    self._journals[0] = journal
                journal.note(None, t, letter)
                windows.note(t // (self.flow.gap or 1), letter)
            self._letters = letters
        if same and t < self.due:
            # Another sample like the last one decides nothing sooner.
            self.now, self._torn = 2 * t + 1, False
        else:
            self._look(2 * t + 1)

    def _begin_windows(self, noted: Sequence[Noted]) -> Windows:
        """Have generated code judge what is open from now on."""
        gap = self.flow.gap or 1
        start, letter = noted[0]
        windows = self._made(start // gap, letter)
        for at, letter in noted:
            windows.note(at // gap, letter)
        self._journals = [self._journal_of(noted), None]
        self._windows = windows
        return windows

    def _journal_of(self, noted: Sequence[Noted]) -> Journal:
        """A journal that begins with what may still be asked for."""
        return journal_of(self.plan, self.flow.gap, noted, self._first_waiting(better=False))

    def _fall_back(self) -> None:
        """Have networks judge what is open."""
        self._clear.forget()
        if self._windows is None:
            super()._begin_network()
            return
        network = self.worse
        self._network, self._windows = network and network.copy(), None
        self._journals = [None, None]
        self._ahead = None

    def _recover(self) -> None:
        """Go on by networks behind an interrupt: those are given whole positions."""
        if self._windows is not None:
            self._fall_back()
        self._torn = False

    def _use_windows(self, t: int) -> None:
        """Go back to generated code once all that was unknown is too long ago to matter.

        What is known of all positions before then leaves an attempt open for good, or only leads on
        to them.
        """
        if not any(one.better is not None and _waits(one) for one in self.attempts):
            noted = self._clear.noted
            self._clear.forget()
            self._network = self.better = None
            self._begin_windows(noted)
            self._look(2 * t + 1)

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
        self._torn = True
        gap, attempts, due = self.flow.gap or 1, self.attempts, NEVER
        found = []
        parted = 0  # what the unknown leaves open comes before all that waits
        while parted < len(attempts) and attempts[parted].token[0] != WAITING:
            parted += 1
        for attempt in islice(attempts, parted, None):
            value, at = windows.outcome(attempt.token[1][0] // gap)
            if at > limit:
                due = at // 2
                break
            found.append((attempt, value, at // 2))
        if found:
            journal.grow(None, limit, position_of(found[0][0]))
            self._stood = None
            for attempt, value, t in found:
                self._decided(attempt, value, max(t, position_of(attempt)), attempt.token)
            del attempts[parted : parted + len(found)]
        if len(attempts) == parted:
            self._windows = self._letters = None
            self._journals = [None, None]
        self.now, self.due = limit, due
        self.restless = self.flow.gap is None and self._windows is not None
        self._torn = False

    def _rest(self) -> None:
        if self._windows is None:
            super()._rest()

    def _wait(self, limit: int) -> None:
        if self._torn:
            self._recover()
        if self._windows is None:
            super()._wait(limit)
        else:
            self._look(limit)

    @property
    def next_due(self) -> int:
        """See `NetworkJudge`."""
        return super().next_due if self._windows is None else self.due

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """See `NetworkJudge`."""
        if self._windows is not None:
            self._fall_back()
        return super().held_at_end(attempt, end, reached)


def _waits(attempt: Open) -> bool:
    """Whether an attempt that is split is waited for."""
    return WAITING in (attempt.token[0], attempt.better and attempt.better[0])
