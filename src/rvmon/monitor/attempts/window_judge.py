"""Open attempts whose windows are followed by generated code, and by a network when need be.

The code tells when which attempt is decided. All else (what is owed and why, what may become of it,
snapshots, what is unknown) is told by the network that it stands for, which is told of the same
positions when somebody asks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

from rvmon.dataflow.chain import Windows
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import FOREVER, Network
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import WAITING, NetworkJudge, position_of
from rvmon.monitor.attempts.network_letters import Letters
from rvmon.runtime.values import NEVER

Noted = tuple[int, Sequence[bool]]
"""An instant and the letter from there on."""


class WindowJudge(NetworkJudge):
    """Judges by generated code; where something is unknown, by networks for a while.

    Args:
        windows: the class of that code.
        reach: ticks after which what was unknown does not matter to it any more.
        *args: as for `NetworkJudge`.
        **kind: the same.
    """

    def __init__(self, windows: type[Windows], reach: int, *args: Any, **kind: Any) -> None:
        self._made, self._reach = windows, reach
        self._network: Network | None = None
        self._windows: Windows | None = None
        self._clear: list[Noted] = []
        """What was noted, while networks judge, since nothing is unknown."""
        self._torn = False
        """Whether the code is at work; else, if an interrupt left it with a part of a position."""
        super().__init__(*args, **kind)

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
            self._mend()
        if self._network is None and self._windows is None:
            self._letters = None
            self.sleeps = -NEVER

    def visit(self, t: int) -> None:
        """See `NetworkJudge`."""
        if self._torn:
            self._mend()
        if self._windows is None and not (self._network is None and self._is_waited_for):
            super().visit(t)
            if self._network is not None and self._letters is not None:
                self._note_clear(t, self._letters)
            return
        letters = self._read(self.flow.values)
        if letters[0] == letters[1]:
            self._follow(t, letters)
            return
        self._fall_back()
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

    def lent(self) -> Sequence[Noted] | None:
        """The letters that what is open may depend on; `None`: not all of them are known."""
        windows, journal = self._windows, self._journals[0]
        if not self.attempts:
            return ()
        if self._torn or windows is None or journal is None:
            return None
        gap = self.flow.gap or 1
        return journal.noted_since(windows.forget(self.position // gap) * gap)

    def take_back(self, attempts: list[Open], noted: Sequence[Noted], limit: int) -> None:
        """Go on with attempts that were judged elsewhere.

        Args:
            attempts: all of which wait.
            noted: the letters that they may depend on.
            limit: the stamp that time has come to.
        """
        self.attempts, self._clear, self._torn = attempts, [], False
        self._network = self.better = self._windows = self._letters = self._stood = None
        self._journals = [None, None]
        self._bounded_at = -FOREVER
        self.now, self.due, self.restless = limit, NEVER, False
        if attempts:
            self._begin_windows(noted)
            self._letters = self._read(self.flow.values)
            self._look(limit)

    def _fall_back(self) -> None:
        """Have networks judge what is open."""
        self._clear = []
        if self._windows is None:
            super()._begin_network()
            return
        network = self.worse
        self._network, self._windows = network and network.copy(), None
        self._journals = [None, None]
        self._bounded_at = -FOREVER

    def _mend(self) -> None:
        """Go on by networks behind an interrupt: those are told of whole positions."""
        if self._windows is not None:
            self._fall_back()
        self._torn = False

    def _note_clear(self, t: int, letters: Letters) -> None:
        """Go back to generated code once all that was unknown is too long ago to matter.

        What is known of all positions before then leaves an attempt open for good, or only leads on
        to them.
        """
        clear = self._clear
        if letters[0] != letters[1]:
            clear.clear()
            return
        if not clear or clear[-1][1] != letters[0] or self.flow.gap is None:
            clear.append((t, letters[0]))
        if t - clear[0][0] <= self._reach:
            return
        self._clear = []
        if not any(one.better is not None and _waits(one) for one in self.attempts):
            self._network = self.better = None
            self._begin_windows(clear)
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
            self._mend()
        if self._windows is None:
            super()._wait(limit)
        else:
            self._look(limit)

    @property
    def next_due(self) -> int:
        """See `NetworkJudge`."""
        self.refresh()
        return super().next_due if self._windows is None else self.due

    def refresh(self) -> None:
        """See when it is due: where samples like the last one are but noted, that may be later."""
        if self._windows is not None and self.flow.gap is None and not self._torn:
            self._look(self.now)

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


def journal_of(
    plan: NetworkPlan, gap: int | None, noted: Sequence[Noted], first: int | None
) -> Journal:
    """A journal of the letters that attempts may depend on.

    Args:
        plan: of the network.
        gap: ticks between two positions; `None` if only samples are positions.
        noted: the letters.
        first: the instant of the first position that is waited for; `None`: none is.
    """
    t, letter = noted[0]
    network = Network(plan, gap)
    if first is not None and first < t:
        network.begin_at(t // (gap or 1), first // (gap or 1), letter)
    return Journal(network, noted)


def _waits(attempt: Open) -> bool:
    """Whether an attempt that is split is waited for."""
    return WAITING in (attempt.token[0], attempt.better and attempt.better[0])
