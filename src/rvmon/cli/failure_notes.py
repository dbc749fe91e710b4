"""Notes on failures, taken while a long recording is judged, so that it is read only once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence, Set
from typing import TYPE_CHECKING

from rvmon.analysis.arrivals import Arrivals
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Amount, Compare, windows_in
from rvmon.language.checked.names_read import names_in, names_read
from rvmon.language.checked.specification import Requirement
from rvmon.recordings.last_updates import ValuesAt
from rvmon.report.tracks import blamed_names
from rvmon.report.wording import SHOWN_PER_REQUIREMENT
from rvmon.session import Spec
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind

if TYPE_CHECKING:
    from rvmon import native
    from rvmon.recordings.batch import Batch
    from rvmon.recordings.recording import FileRecording
    from rvmon.verdicts.attempt import Attempt

MOST_LATE = 1000
"""The most failures of a requirement for which late responses are looked up."""

MOST_LATE_IN_ALL = 10_000
"""The most for all requirements together; each gets an equal share, at least one."""

MOST_VALUES = 3  # the most signals of a failed part whose values are shown; `rvmon why` shows all


def looked_up(requirement: Requirement, failed: int) -> int:
    """The number of failures of a requirement to look up, if `failed` requirements failed."""
    # Each set of captured values, and each instance, takes its own pass over the recording.
    if requirement.for_each or requirement.captures:
        return SHOWN_PER_REQUIREMENT
    return max(1, min(MOST_LATE, MOST_LATE_IN_ALL // failed))


class FailureNotes:
    """Notes on the failures of a recording, taken while it is judged."""

    def __init__(
        self, spec: Spec, recording: FileRecording, only: Sequence[str] | None, core: native.Monitor
    ) -> None:
        self._spec = spec
        self._core = core
        self._numbers = spec.planned(only).packed.numbers
        self._wanted = bytearray(b"\1" * len(self._numbers))
        self._records = 0
        self._failed: Counter[str] = Counter()
        self._arrivals = None if recording.outages else Arrivals(spec.checked, recording.names)
        # by requirement and number of the attempt, the instant of a late response, ticks; `None`:
        # there was none, or nothing was awaited. Attempts that need a second reading are absent
        self.late = {} if self._arrivals is None else self._arrivals.arrived
        self.values = values_at(spec)  # the values at failures, without those that need a reading

    def take(self, pieces: Sequence[Batch | Sample], until: int) -> None:
        """Take the pieces that were judged next; they are complete up to `until` (ticks)."""
        self._records, attempts = self._core.failed(self._records, bytes(self._wanted))
        for attempt in attempts:
            self._ask_about(attempt)
        if pieces:
            self.values.take(pieces)
        if self._arrivals is not None:
            self._arrivals.take(pieces, until)

    def finish(self, pieces: Sequence[Batch | Sample], end: int) -> None:
        """Take the last pieces of a recording that ends at `end` (ticks)."""
        self.take(pieces, end)
        self.values.finish()

    def _ask_about(self, attempt: Attempt) -> None:
        name = attempt.requirement
        requirement = self._spec.requirements[name]
        self._failed[name] += 1
        # As more requirements fail, the share of each shrinks, so a full one stays full.
        if self._failed[name] > looked_up(requirement, len(self._failed)):
            self._wanted[self._numbers[name]] = 0
            return
        if self._failed[name] <= SHOWN_PER_REQUIREMENT and attempt.blame is not None:
            self.values.ask(attempt.decided or 0, names_blamed(self._spec, attempt))
        if self._arrivals is not None:
            self._arrivals.ask(attempt)


def values_at(spec: Spec) -> ValuesAt:
    """A finder for the values, at failures, of the signals that consequents read."""
    checked = spec.checked
    names = {
        name
        for requirement in spec.requirements.values()
        for name in names_read(requirement.consequent)
        if name in checked.signals and checked.signals[name].type.kind is not Kind.BOOL
    }
    stale_after = {name: signal.stale_after for name, signal in checked.signals.items()}
    return ValuesAt(names, checked.ignoring, stale_after)


def names_blamed(spec: Spec, attempt: Attempt) -> Set[str]:
    """The signals whose values explain a failure with a known blame; empty if there are too many.

    Excluded are `bool` signals and names measured over a window.
    """
    assert attempt.blame is not None, "only these are asked for"
    requirement = spec.requirements[attempt.requirement]
    measured: set[str] = set()
    for subformula in subformulas(requirement.consequent):
        if isinstance(subformula, Amount):
            measured |= {*names_read(subformula)}
        elif isinstance(subformula, Compare):
            windows = windows_in(subformula.left, subformula.right)
            measured |= {name for window in windows for name in names_in(window)}
    signals = spec.checked.signals
    signals_blamed = {
        name
        for name in blamed_names(requirement, attempt.blame) - measured
        if name in signals and signals[name].type.kind is not Kind.BOOL
    }
    return signals_blamed if len(signals_blamed) <= MOST_VALUES else set()
