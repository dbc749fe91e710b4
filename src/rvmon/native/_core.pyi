from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from rvmon.monitor.robustness import Measured, Robustness
from rvmon.verdicts.attempt import Attempt

source_hash: str

def memory_of(plan: bytes, attempts: int, /) -> int:
    """The size in bytes of a block, aligned to 16, for a run with room for this many open attempts.

    Raises:
        ValueError: the plan is damaged, or its bytes are not aligned to 8.
    """

class Record:
    """The fields of an attempt, as the core sets them; `Attempt` derives from it and types them."""

    _details: Callable[[Any, Any, str], Mapping[str, Any]]
    _noted: Any

class Bounds:
    """Three numbers; `Robustness` derives from it and names them."""

class Figure:
    """A robustness figure that makes its `Bounds` when read; `Measured` derives from it."""

class Monitor:
    """A run of a packed plan; `core.h` explains the calls that are not explained here.

    Args:
        plan: the bytes.
        reading: the numbers of the names that can arrive; per signal, event and field the number of
            each label or field, or `None`; for each of these its kind, in the order of `Kind`; per
            event whether only one occurrence can be judged at an instant, and per signal whether
            an unknown value is no update.
        absent: per name, whether it has no source.
        slow_step: two functions that take samples which are not plain values in a `dict`: stamped
            in seconds, and in ticks.
        attempts: the type of attempts, which derives from `Record`; the ids of requirements; the
            verdicts; the decisions; a function that computes the other fields of an attempt; a
            function that makes a sequence from raw records, or `None`.

    Raises:
        ValueError: the plan is damaged, or the other arguments do not fit it.
    """

    def __new__(
        cls,
        plan: bytes,
        reading: tuple[dict[str, int], tuple[Mapping[str, int] | None, ...], bytes, bytes],
        absent: bytes,
        slow_step: tuple[Any, Any],
        attempts: tuple[
            type[Attempt],
            tuple[str, ...],
            tuple[Any, ...],
            tuple[Any, ...],
            Callable[[Attempt, Any, str], Mapping[str, Any]],
            Callable[[Any], Sequence[Attempt]] | None,
        ],
        /,
    ) -> Monitor: ...
    def step(self, t: float, values: Mapping[str, Any]) -> Sequence[Attempt]: ...
    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]: ...
    def judge(self, t: int, values: Mapping[str, Any], checked: bool, /) -> bool:
        """Take a sample; returns False, without effect, if it is not plain or not in order.

        `checked`: Python has checked that all its occurrences can be judged.
        """

    def rows(self, times: Any, columns: tuple[tuple[Any, ...], ...], /) -> int:
        """Judge rows; returns how many were judged.

        It stops before a row that is earlier than the one above it, and before the first instant
        with two payloads of an event of which only one can be judged.

        Args:
            times: int64[n] ticks; the rows of one instant are one sample.
            columns: for a signal (number, cells), for an event (number, says, the cells of each
                field or `None`). Cells are (kind, values, says): an `RV_COLUMN_…` of `core.h`; an
                array of n values, which may be `None` for a field; and uint8[n], what each row
                says, or `None`.
        """

    def advance(self, t: int, /) -> None: ...
    def lose(self, names: Iterable[int], since: int, /) -> bool:
        """See `rv_lose`; returns False, without effect, if that instant was already judged.

        Raises:
            ValueError: the plan has no such name.
        """

    def found(self, names: Iterable[int], at: int, /) -> bool:
        """See `rv_found`; otherwise like `lose`."""

    def late(self, names: Iterable[int] | None, t: int, /) -> bool:
        """See `rv_late`; `None`: the sample cannot be read.

        Raises:
            ValueError: the plan has no such name.
        """

    def finish(self, until: int | None, /) -> int | None:
        """End the run; returns the last instant of the trace."""

    def reset(self) -> None: ...
    def save(self) -> bytes:
        """The state of the run; a loaded run does not return the decided attempts again."""

    def load(self, data: bytes, /) -> bool:
        """Continue a saved run; returns False, without effect, if it is not a run of this plan."""

    def arrivals(self) -> bytes:
        """Input health per name, then per field of events, as five int64 each.

        These are the instant of a signal's first update (the least int64 if none); how often the
        value was `None`, and when first; the same for NaN.
        """

    def take_arrivals(self, data: bytes, /) -> bool:
        """Continue from what `arrivals` returned; returns False if it does not fit the plan."""

    def keep(self, most: int, /) -> None:
        """See `rv_keep`; records are dropped only after they were returned."""

    def flush(self) -> Sequence[Attempt]:
        """The attempts decided since the last call."""

    def failed(self, first: int, wanted: bytes, /) -> tuple[int, tuple[Attempt, ...]]:
        """The number of records, and the failed attempts among the records from `first` on.

        Only those of requirements whose byte in `wanted` is not 0.
        """

    def open(self) -> tuple[Attempt, ...]:
        """The attempts that are undecided now, and those that will stay undecided."""

    def records(self) -> tuple[bytes, bytes, bytes, list[tuple[tuple[bytes, ...], bytes, int]]]:
        """All records as `rv_record`; their captured values as `rv_number`; notes; and letters.

        Each record has room for the most values that any requirement captures. Notes are int64
        words. Each span of letters that notes refer to is a tuple: the full pieces; bytes that
        start with the last piece; and the number of words of the last piece.
        """

    def counts(self) -> list[tuple[int, int, int, int]]:
        """Per requirement, how many attempts failed, passed and stayed open, and a flag.

        The flag is 1 if its trigger was ever true or false, and no sample came too late for it.
        """

    def truths(self, operator: int, /) -> tuple[bytes, bytes]:
        """Where an operator of the plan's truths is certainly true, and where certainly false.

        Ranges of positions as pairs of int64, first and last; see `rv_truths`.

        Raises:
            ValueError: the plan does not record the truths of that operator.
        """

    def stale(self) -> list[tuple[int, int, int]]:
        """For each signal that went stale, its number, how often it did, and when first."""

    def passages(self, requirement: int, /) -> tuple[int, bytes]:
        """The number of locations of an automaton, and the moves of attempts between them.

        For each pair of locations two int64: how often, and when first; see `rv_moves`. The number
        is 0 if the plan does not request them.
        """

    def situation(self, now: int, /) -> tuple[bytes, int | None]:
        """The state of the run relative to `now`, equal for runs that continue alike.

        Also the next instant at which time alone may change something. See `rv_situation`.

        Raises:
            ValueError: the run is over or in an outage, `now` is before its last sample, or the
                plan has a chain.
        """

    def hits(self) -> bytes:
        """For each item of the plan's groups two int64: how often it was hit, and when first."""

    def times(self) -> tuple[int | None, int | None, int | None]:
        """The instants of the first and the last sample, and how far time has advanced."""

    def next_due(self) -> int | None: ...
    def measure(self, figures: tuple[type[Measured], type[Robustness]], positions: bool, /) -> None:
        """Have steps return figures instead of attempts; for a plan that measures robustness.

        Args:
            figures: the types, which derive from `Figure` and `Bounds`.
            positions: see `rv_measure_positions`.
        """

    def figures(self) -> Sequence[Measured]:
        """The figures that became final since the last call; records of attempts are dropped."""

    def open_figures(self) -> list[Measured]:
        """The current bounds of the figures that are not final."""

    def margins(self) -> bytes:
        """The figures that became final since the last call, as `rv_margin`."""

    def memory_used(self) -> int:
        """The bytes of memory taken so far; reused memory counts once. See `rv_memory_used`."""

    def hold(self, held: bool, /) -> bool:
        """Start or end a call that is partly done in Python; meanwhile `step` takes no fast path.

        Returns False, without effect, during another call.
        """
