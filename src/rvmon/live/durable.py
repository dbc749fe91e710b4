"""A monitor whose run survives any end of its process."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.errors import RvmonError, SnapshotError, TimeOrderError, TraceError
from rvmon.execute.journal import add, create, entries
from rvmon.trace.time import whole_ticks

if TYPE_CHECKING:
    from rvmon.monitor.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdicts.attempt import Attempt

Report = Callable[[int, "Attempt"], object]


class DurableMonitor:
    r"""A monitor that continues where it was when its process was killed.

    Its file contains a snapshot and the samples since then (a write-ahead log): each sample is
    written before it is judged. So every verdict is reported at least once. Verdicts reported
    shortly before a kill are reported again under the same number, so that a reader recognises
    repetitions.

    Writes are not synced, so a loss of power may lose the latest samples.

    Args:
        spec: the specification.
        path: of the file; if it exists, its run is continued.
        report: called with the number, from 1, and the record of each attempt that passes or fails.
            An exception propagates from the deciding call; the verdict counts as reported.
        every: the number of samples after which a new snapshot is written.
        **options: as for `Spec.monitor`, for a new run; a continued run keeps its options.

    Attributes:
        monitor: the monitor; only to be queried.
        taken: the number of samples since the run started, including refused and lost ones; a
            source that can be read again is to be resumed after these.
        mark: a count and a checksum with which the caller can recognise the source; stored with
            snapshots.

    Raises:
        SnapshotError: the file contains no run, or one of another specification or version.
        OSError: the file cannot be read or written.

    >>> from tempfile import TemporaryDirectory
    >>> from rvmon import loads
    >>> spec = loads("spec s\nsignal x : real\nrequirement R\n  always x < 3\n")
    >>> say = lambda number, attempt: print(number, attempt.name, attempt.verdict.name)
    >>> with TemporaryDirectory() as folder:
    ...     DurableMonitor(spec, f"{folder}/run", say).step_ns(0, {"x": 5.0})
    ...     DurableMonitor(spec, f"{folder}/run", say).step_ns(1, {"x": 2.0})
    ...     DurableMonitor(spec, f"{folder}/run", say).step_ns(2, {"x": 4.0})
    1 R#1 FAIL
    1 R#1 FAIL
    2 R#2 FAIL
    """

    def __init__(
        self, spec: Spec, path: str | Path, report: Report, *, every: int = 1000, **options: Any
    ) -> None:
        if type(every) is not int or every < 1:
            raise RvmonError(f"every={every!r}: expected a whole number of at least 1")
        self._path = Path(path)
        self._report = report
        self._every = every
        self._number = 0
        self.taken = 0
        self.mark = (0, 0)
        kept = self._kept_lines()
        self.monitor = spec.monitor(**options) if kept is None else self._taken_up(spec, kept)
        self.monitor.on_decided(self._hear)
        for line in [] if kept is None else kept[1:]:
            self._replay(line)
        # The verdicts of these samples are reported now: a new snapshot includes them.
        self.save()

    def _kept_lines(self) -> list[bytes] | None:
        if self._path.exists() and not (self._path.is_file() or self._path.is_dir()):
            # Reading a pipe or device might never end.
            raise SnapshotError(f"{self._path} is not a regular file: name one")
        try:
            return entries(self._path, strict=True)
        except ValueError as error:  # later samples cannot be judged without the damaged one
            raise SnapshotError(
                f"{self._path}: {error}, and not the last one: name another file, or delete this "
                "one to start again"
            ) from None

    def _taken_up(self, spec: Spec, kept: list[bytes]) -> Monitor:
        try:
            head = json.loads(kept[0])
            self._number, data = int(head["reported"]), str(head["snapshot"]).encode()
            self.taken = int(head["taken"])
            count, check = head.get("mark", self.mark)
            self.mark = int(count), int(check)
        except (ValueError, LookupError, TypeError, RecursionError):
            raise SnapshotError(
                f"{self._path}: no run of a monitor, or its start is damaged: name another file, "
                "or delete this one to start again"
            ) from None
        try:
            return spec.restore(data)
        except SnapshotError as error:
            raise SnapshotError(f"{self._path}: {error}") from None

    def _replay(self, line: bytes) -> None:
        try:
            t, values = json.loads(line)
        except (ValueError, TypeError, RecursionError):
            raise SnapshotError(f"{self._path}: its content is not a sample") from None
        with suppress(TraceError):  # the sample was refused in the first run, too
            self._judge(t, values)

    def _judge(self, t: int | None, values: Mapping[str, Any] | None) -> None:
        self.taken += 1
        if t is None:
            self.monitor.miss(values)
        elif values is None:
            self.monitor.advance_ns(t)
        else:
            try:
                self.monitor.step_ns(t, values)
            except TraceError as error:
                self._refused(t, values, error)
                raise

    def _refused(self, t: int, values: Mapping[str, Any], error: TraceError) -> None:
        """Report the names of a refused sample as lost or late."""
        checked = self.monitor.compiled.checked
        names = [name for name in values if name in checked.signals or name in checked.events]
        if isinstance(error, TimeOrderError):
            self.monitor.late_ns(names, t)
        else:
            self.monitor.lose_ns(names, t, t, why="refused")

    def _hear(self, attempt: Attempt) -> None:
        self._number += 1
        self._report(self._number, attempt)

    def save(self) -> None:
        """Write a snapshot; verdicts reported so far are not reported again.

        Raises:
            OSError: the file cannot be written; it is unchanged.
        """
        head = {
            "reported": self._number,
            "taken": self.taken,
            "mark": self.mark,
            "snapshot": self.monitor.snapshot().decode(),
        }
        create(self._path, [json.dumps(head).encode()])
        self._kept = 0

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> None:
        """Judge a sample, as `Monitor.step_ns` does; verdicts are reported.

        Raises:
            TraceError: the monitor refuses the sample; its names are unknown at its instant.
            OSError: the file cannot be written; nothing was judged.
        """
        self._keep(whole_ticks(t_ns), dict(values))

    def advance_ns(self, t_ns: int) -> None:
        """State that no sample before `t_ns` will come; otherwise as `step_ns`."""
        self._keep(whole_ticks(t_ns), None)

    def miss(self, names: Iterable[str] | None = None) -> None:
        """Report that input was lost between the last sample and the next; see `Monitor.miss`."""
        self._keep(None, None if names is None else dict.fromkeys(names))

    def _keep(self, t: int | None, values: Mapping[str, Any] | None) -> None:
        try:
            line = json.dumps([t, values], default=_plain).encode()
        except (TypeError, ValueError, RecursionError) as error:
            raise TraceError(f"a sample that cannot be kept: {error}") from None
        # Write before judging, so that a failure to write changes nothing.
        if self._kept >= self._every:
            self.save()
        add(self._path, line)
        self._kept += 1
        self._judge(t, values)


def _plain(value: object) -> object:
    """A NumPy scalar as a plain Python value."""
    item = getattr(value, "item", None)
    if item is None:
        raise TypeError(f"`{type(value).__name__}` is not a value of a signal or an event")
    return item()
