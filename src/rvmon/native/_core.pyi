from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from rvmon.monitor.robustness import Measured, Robustness
from rvmon.verdicts.attempt import Attempt

source_hash: str

def memory_of(plan: bytes, attempts: int, /) -> int:
    """The bytes of a block, aligned to 16, in which a run begins with room for open attempts.

    Raises:
        ValueError: the plan is damaged, or the bytes are not aligned to 8.
    """

class Record:
    """The fields of an attempt that the core tells; `Attempt` derives from it and types them."""

    _details: Callable[[Any, Any, str], Mapping[str, Any]]
    _noted: Any

class Bounds:
    """Three numbers; `Robustness` derives from it and names them."""

class Figure:
    """What a figure says, of which bounds are made as they are read; `Measured` derives from it."""

class Monitor:
    """A run of a packed plan; what a call does that is not explained here, `core.h` says.

    Args:
        plan: the bytes.
        reading: the numbers of the names that can come; per signal, event and field a number for
            each label or field, or `None`; of each what it is, in the order of `Kind`; of each
            event whether only one occurrence of it can be judged at an instant, of each signal
            whether that it is unknown is no update.
        absent: of each name whether it has no source.
        look_closer: take the samples that are not plain values in a `dict`, at seconds, at ticks.
        attempts: the type, which derives from `Record`, ids of requirements, verdicts, decisions,
            what gives an attempt its other fields, what makes a sequence of raw records.

    Raises:
        ValueError: the plan is damaged, or all this does not fit it.
    """

    def __new__(
        cls,
        plan: bytes,
        reading: tuple[dict[str, int], tuple[Mapping[str, int] | None, ...], bytes, bytes],
        absent: bytes,
        look_closer: tuple[Any, Any],
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
    def judge(self, t: int, values: Mapping[str, Any], looked: bool, /) -> bool:
        """Take a sample; false, and nothing happened, if it is not plain or not in order.

        `looked`: it is known that all its occurrences can be judged.
        """

    def rows(self, times: Any, columns: tuple[tuple[Any, ...], ...], /) -> int:
        """Judge rows; how many were: fewer than given if one is before those above it.

        Fewer, too, before the first instant with two payloads of an event of which only one can be
        judged.

        Args:
            times: int64[n] ticks; those of one instant are one sample.
            columns: of a signal (number, cells), of an event (number, says, cells of each field or
                `None`). Cells are (kind, values, says): the `RV_COLUMN_…` of `core.h`, an array of
                n values, which may be `None` of a field, and uint8[n] of what each row says or
                `None`.
        """

    def advance(self, t: int, /) -> None: ...
    def lose(self, names: Iterable[int], since: int, /) -> bool:
        """See `rv_lose`; false, and nothing happened, if what is there was judged already.

        Raises:
            ValueError: the plan is of a law by which nothing is lost, or has no such name.
        """

    def found(self, names: Iterable[int], at: int, /) -> bool:
        """See `rv_found`; else as `lose`."""

    def late(self, names: Iterable[int] | None, t: int, /) -> bool:
        """See `rv_late`; `None`: what came cannot be read.

        Raises:
            ValueError: the plan has no such name.
        """

    def finish(self, until: int | None, /) -> int | None:
        """End the run; gives the last instant of the trace."""

    def reset(self) -> None: ...
    def save(self) -> bytes:
        """The run as it stands; what was decided counts as given out."""

    def load(self, data: bytes, /) -> bool:
        """Go on as a run that was saved; false, and nothing is done, if it is none of this plan."""

    def arrivals(self) -> bytes:
        """What came of each name, then of each field of events: five int64.

        The first instant at which a signal was told, or the least number; how often the value was
        `None`, and when first; the same of NaN.
        """

    def take_arrivals(self, data: bytes, /) -> bool:
        """Go on from what `arrivals` gave; false, if it is none of this plan."""

    def keep(self, most: int, /) -> None:
        """See `rv_keep`; records are dropped once they were given out."""

    def flush(self) -> Sequence[Attempt]:
        """The attempts that were decided since the last call."""

    def failed(self, first: int, wanted: bytes, /) -> tuple[int, tuple[Attempt, ...]]:
        """The number of records, and the attempts that failed among those from `first` on.

        Of the requirements with a 1 in `wanted`, which has a byte for each.
        """

    def open(self) -> tuple[Attempt, ...]:
        """The attempts that are undecided now, and those that will stay so."""

    def records(self) -> tuple[bytes, bytes, bytes, list[tuple[tuple[bytes, ...], bytes, int]]]:
        """All records as `rv_record`, and as many `rv_number` for each as any captures.

        Then the words of notes, and the letters that these refer to: pieces, and bytes that begin
        with the last piece, which has so many words.
        """

    def counts(self) -> list[tuple[int, int, int, int]]:
        """Of each requirement how many attempts failed, passed, stayed open.

        The last number is 1 if its trigger was ever true or false, and nothing came too late.
        """

    def truths(self, operator: int, /) -> tuple[bytes, bytes]:
        """Where an operator of the plan's truths is surely true, and where surely false.

        Ranges of positions, see `rv_truths`: first and last, int64 each.

        Raises:
            ValueError: the plan keeps no truths of that.
        """

    def stale(self) -> list[tuple[int, int, int]]:
        """Of each signal that went stale its number, how often it did, and when first."""

    def passages(self, requirement: int, /) -> tuple[int, bytes]:
        """How many locations its automaton has, and from each to each how often attempts went.

        With that, when first: int64 each; see `rv_moves`. 0: the plan does not ask for it.
        """

    def situation(self, now: int, /) -> tuple[bytes, int | None]:
        """How the run stands; equal for runs that go on alike. See `rv_situation`.

        With that, the next instant at which time alone may change something.

        Raises:
            ValueError: the run is over, `now` is before its last sample, or the plan has a chain.
        """

    def hits(self) -> bytes:
        """Of each item of the plan's groups how often it was hit, and when first: int64 each."""

    def times(self) -> tuple[int | None, int | None, int | None]:
        """The instants of the first and the last sample, and that which time has come to."""

    def next_due(self) -> int | None: ...
    def measure(self, figures: tuple[type[Measured], type[Robustness]], positions: bool, /) -> None:
        """Have steps give figures, not attempts; of a plan that says what is measured.

        Args:
            figures: the types, which derive from `Figure` and `Bounds`.
            positions: see `rv_measure_positions`.
        """

    def figures(self) -> Sequence[Measured]:
        """The figures that were settled since the last call; no records are kept."""

    def open_figures(self) -> list[Measured]:
        """What is known of attempts whose figures are to come."""

    def margins(self) -> bytes:
        """The figures that were settled since the last call as `rv_margin`."""

    def memory_used(self) -> int:
        """The bytes that it has taken for what it keeps; those given back serve again."""

    def hold(self, held: bool, /) -> bool:
        """Begin or end a call of which Python does a part: meanwhile no sample is taken quickly.

        False, and nothing is done, amid another call.
        """
