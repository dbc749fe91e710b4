"""The budget and the cost of a search; the answer to a query."""

from __future__ import annotations

import gc
import mmap
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from rvmon.models.network import Query
from rvmon.models.runs import Run


@dataclass(frozen=True, slots=True)
class Budget:
    """The limits at which a search stops undecided; `None`: no limit."""

    states: int | None = None  # symbolic states visited
    seconds: float | None = None  # of wall-clock time
    megabytes: int | None = None  # of memory of the whole process


UNLIMITED = Budget()


@dataclass(frozen=True, slots=True)
class Progress:
    """The progress of a search: symbolic states visited and waiting, seconds since the start."""

    visited: int
    waiting: int
    seconds: float


Watch = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class Statistics:
    """The cost of a search."""

    visited: int  # symbolic states that no stored state covered when they were found
    stored: int  # the states of these that were not replaced by a larger one
    seconds: float  # of wall-clock time


class Policy(StrEnum):
    """Which run is shown for a reachable state, if there are several."""

    SHORTEST = "shortest"  # one with the fewest actions
    FASTEST = "fastest"  # one that takes the least time
    LIKELIEST = "likely"  # one with the largest product of edge weights


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether a query holds, and a run that shows why or why not."""

    query: Query
    holds: bool | None  # `None` if the budget was exhausted
    run: Run | None  # a witness where `E` holds, a counterexample where `A` or `-->` does not
    policy: Policy | None  # how the run was chosen; `None` if there was no choice
    statistics: Statistics
    remark: str = ""  # for people: why it is not decided, or that time stops on the run


class Meter:
    """Counts states against a budget and reports the progress of a search."""

    def __init__(self, budget: Budget, watch: Watch | None) -> None:
        self._budget = budget
        self._watch = watch
        self._start = time.perf_counter()
        self.visited = 0  # states visited in completed searches
        self.stored = 0  # states that completed searches stored
        self.stopped = ""  # the limit that was reached; empty if none was

    @property
    def seconds(self) -> float:
        """Seconds since the meter was created."""
        return time.perf_counter() - self._start

    def statistics(self) -> Statistics:
        """The counts so far."""
        return Statistics(self.visited, self.stored, self.seconds)

    @property
    def left(self) -> int:
        """The number of states that may still be visited; −1 if unlimited."""
        states = self._budget.states
        return -1 if states is None else max(0, states - self.visited)

    def look(self, visited: int, waiting: int = 0) -> bool:
        """Check time and memory and report progress, for a running search; whether to continue."""
        budget, seconds = self._budget, self.seconds
        if budget.seconds is not None and seconds > budget.seconds:
            self.stopped = f"{budget.seconds:g} s went by"
        elif budget.megabytes is not None and _is_full(budget.megabytes):
            self.stopped = f"{budget.megabytes:,} MB of memory were in use"
        elif self._watch is not None:
            self._watch(Progress(self.visited + visited, waiting, seconds))
        return not self.stopped

    def add(self, visited: int, stored: int) -> None:
        """Add the counts of a completed search."""
        self.visited += visited
        self.stored += stored

    def stop(self, reason: str) -> None:
        """Record why a search stopped, unless a reason is already known."""
        self.stopped = self.stopped or reason

    def stop_at_states(self) -> None:
        """Record that the limit of states was reached, unless another reason is known."""
        self.stop(f"{self._budget.states or 0:,} states were visited")


def _is_full(limit: int) -> bool:
    if _megabytes() <= limit:
        return False
    gc.collect()  # earlier searches leave reference cycles
    return _megabytes() > limit


def _megabytes() -> float:
    """The current memory of the process; its peak, or 0, where the system reports no more."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
        return pages * mmap.PAGESIZE / (1 << 20)
    except OSError:
        pass
    try:
        import resource
    except ImportError:
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
