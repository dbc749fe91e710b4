"""A compiled monitor as a function over columns."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_build import NATIVE, Build, loaded
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_exact import too_large, whole_limits
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_samples import value_type
from rvmon.codegen.c_source import c_files
from rvmon.errors import RvmonError
from rvmon.plan.plan import Plan

if TYPE_CHECKING:
    from numpy.typing import NDArray

NOTHING, NO, UNKNOWN, YES = range(4)
"""What a row says of a name."""

SAMPLE, ADVANCE, MORE = range(3)
"""What a row is."""

WHERE_IT_ENDS = -(1 << 63)

_RECORD = [
    ("requirement", np.int32),
    ("number", np.uint32),
    ("triggered", np.int64),
    ("decided", np.int64),
    ("verdict", np.uint8),
    ("decision", np.uint8),
    ("in_doubt", np.uint8),
]


def record_type(plan: Plan) -> np.dtype[Any]:
    """The record of an attempt; verdict and decision count in `rvmon.codegen.c_tables`.

    Args:
        plan: of the monitor.
    """
    count = CapturedValues(plan).count
    captured = [("captured", np.float64, (count,))] if count else []
    return np.dtype([*_RECORD, *captured], align=True)


@dataclass(frozen=True, slots=True)
class Column:
    """One signal, event or payload field.

    Attributes:
        states: uint8[n], what each row says; of a field, left out; of a signal, left out if every
            row has a value.
        values: of a Boolean signal bool[n], of others float64[n] with labels by number; of an
            event, left out.
    """

    states: NDArray[np.uint8] | None = None
    values: NDArray[Any] | None = None


@dataclass(frozen=True, slots=True)
class RunRecords:
    """What a compiled monitor found in a recording.

    Attributes:
        records: array of `record_type`, in the order in which they were made.
        ordered: whether that is the order of reports.
        counts: int64[requirements, 4], how many attempts failed, passed, and stayed inconclusive,
            and 1 if the trigger was ever true or false.
        end: the last instant of the trace; `None` if it has none.
    """

    records: NDArray[Any]
    ordered: bool
    counts: NDArray[np.int64]
    end: int | None


class _In(ctypes.Structure):
    _fields_ = (
        ("n", ctypes.c_int64),
        ("t", ctypes.c_void_p),
        ("advance", ctypes.c_void_p),
        ("signal", ctypes.c_void_p),
        ("value", ctypes.c_void_p),
        ("event", ctypes.c_void_p),
        ("field", ctypes.c_void_p),
    )


def _library(path: Path) -> ctypes.CDLL:
    return ctypes.CDLL(str(path))


def batch_build(plan: Plan, *, optimised: bool = True) -> Build:
    """The shared library of a plan.

    Args:
        plan: of requirements that all have automata.
        optimised: whether it is to be fast; otherwise it is compiled sooner.

    Raises:
        RvmonError: a number of the specification is no double.
    """
    made = c_files(plan)
    speed = ("-O3", "-fno-math-errno", NATIVE) if optimised else ("-O0",)
    sources = [f"{made.prefix}_batch.c", *made.units]
    return Build(made.texts, sources, ".so", [*speed, "-shared", "-fPIC"])


class BatchLibrary:
    """A plan compiled to a shared library.

    Args:
        plan: of requirements that all have automata.
        optimised: whether it is to be fast; otherwise it is compiled sooner.

    Raises:
        RvmonError: there is no C compiler, a requirement has no automaton, or a whole number is no
            double.
    """

    def __init__(self, plan: Plan, *, optimised: bool = True) -> None:
        self.names = Names(plan)
        self.plan = plan
        self.limits = whole_limits(plan)
        self.record = record_type(plan)
        library = loaded(batch_build(plan, optimised=optimised), _library)
        address, number = ctypes.c_void_p, ctypes.c_int64

        def function(name: str, result: Any, *arguments: Any) -> Any:
            found = library[f"{self.names.prefix}_{name}"]
            found.restype, found.argtypes = result, arguments
            return found

        self.open = function("open", address, address)
        self.feed = function("feed", number, address, address)
        self.close = function("close", number, address, number)
        self.records = function("records", number, address, address)
        self.counts = function("counts", ctypes.c_bool, address, ctypes.c_int32, address)
        self.trouble = function("trouble", ctypes.c_int32, address)
        self.free = function("free", None, address)
        rows = ctypes.c_int64()
        sizes = function("sizes", number, address)
        if (sizes(ctypes.byref(rows)), rows.value) != (self.record.itemsize, ctypes.sizeof(_In)):
            raise RvmonError("the C compiler lays out records otherwise than Python does")


class BatchRun:
    """One recording, fed in pieces; a context manager.

    Args:
        library: compiled for the specification.
        absent: the names without a source.
    """

    def __init__(self, library: BatchLibrary, absent: frozenset[str] = frozenset()) -> None:
        self._library = library
        self._fields = [f"{event}.{field}" for event, field in library.names.fields]
        self._records: list[bytes] = []
        flags = np.zeros(max(len(library.plan.signals) + len(library.plan.events), 1), np.uint8)
        for name in absent:
            flags[library.names.number(name)] = 1
        self._batch = library.open(flags.ctypes.data)
        if not self._batch:
            raise RvmonError("not enough memory")

    def __enter__(self) -> BatchRun:
        return self

    def __exit__(self, *_: object) -> None:
        self._library.free(self._batch)

    def feed(
        self,
        times: NDArray[np.int64],
        columns: Mapping[str, Column],
        kinds: NDArray[np.uint8] | None = None,
    ) -> int:
        """Judge some rows.

        Args:
            times: int64[n] ticks, strictly increasing but for rows of further payloads.
            columns: by signal, event, and `event.field`; what is left out does not come.
            kinds: uint8[n], what each row is: `ADVANCE` says how far time has come, `MORE` holds
                further payloads of the sample that comes next; `None`: all are samples.

        Returns:
            How many rows were taken: fewer than given if one is out of order.

        Raises:
            TraceError: a whole number is larger than C computes with exactly.
            RvmonError: memory ran out, or a static capacity.
        """
        plan = self._library.plan
        bare = {name: one.values for name, one in columns.items()}
        laid = exact_columns(plan, self._library.limits, times, bare)
        keep: list[Any] = [times := np.ascontiguousarray(times, np.int64), kinds]
        none = Column()
        values = [laid.get(name) for name in plan.signals]
        given = _In(
            n=len(times),
            t=times.ctypes.data,
            advance=None if kinds is None else kinds.ctypes.data,
            signal=_pointers([columns.get(name, none).states for name in plan.signals], keep),
            value=_pointers(values, keep),
            event=_pointers([columns.get(name, none).states for name in plan.events], keep),
            field=_pointers([columns.get(name, none).values for name in self._fields], keep),
        )
        rows: int = self._library.feed(self._batch, ctypes.byref(given))
        self._take_records()
        return rows

    def close(self, until: int | None = None) -> RunRecords:
        """End the run.

        Args:
            until: the end of the trace, if it is after all rows.
        """
        end = self._library.close(self._batch, WHERE_IT_ENDS if until is None else until)
        self._take_records()
        counts = np.zeros((len(self._library.plan.asked), 4), np.int64)
        ordered = True
        for index, own in enumerate(counts):
            ordered = self._library.counts(self._batch, index, own.ctypes.data)
        return RunRecords(
            np.frombuffer(b"".join(self._records), self._library.record),
            ordered,
            counts,
            None if end == WHERE_IT_ENDS else end,
        )

    def _take_records(self) -> None:
        trouble = self._library.trouble(self._batch)
        if trouble:
            what = "memory for the open attempts"
            raise RvmonError(f"not enough {what if trouble == 1 else 'room for a past operator'}")
        start = ctypes.c_void_p()
        count = self._library.records(self._batch, ctypes.byref(start))
        if count:
            self._records.append(ctypes.string_at(start, count * self._library.record.itemsize))


def _expect_exact(
    name: str, values: NDArray[Any] | None, limit: int, times: NDArray[np.int64]
) -> None:
    """See that a column of whole numbers, if it is one, keeps to its limit."""
    if values is None or values.dtype.kind != "i" or not len(values):
        return
    if -limit <= int(values.min()) and int(values.max()) <= limit:
        return
    row = int(np.flatnonzero((values < -limit) | (values > limit))[0])
    raise too_large(name, int(values[row]), limit, int(times[row]))


def exact_columns(
    plan: Plan,
    limits: Mapping[str, int],
    times: NDArray[np.int64],
    columns: Mapping[str, NDArray[Any] | None],
) -> dict[str, NDArray[Any]]:
    """The columns as C reads them: of truth values bool[n], else float64[n].

    Args:
        plan: of the monitor.
        limits: of whole numbers, by name.
        times: int64[n] ticks, of the rows.
        columns: by name, be it a field's; `None` never comes.

    Raises:
        TraceError: a whole number is larger than C computes with exactly.
    """
    for name, limit in limits.items():
        _expect_exact(name, columns.get(name), limit, times)
    types = {name: bool if value_type(plan, name) == "uint8_t" else float for name in plan.signals}
    types |= dict.fromkeys(plan.events, bool)
    return {
        name: np.ascontiguousarray(values, types[name])
        for name, values in columns.items()
        if values is not None and name in types
    }


def _pointers(arrays: Sequence[NDArray[Any] | None], keep: list[Any]) -> int:
    """The address of an array of the addresses of arrays."""
    made = (ctypes.c_void_p * max(len(arrays), 1))()
    for index, one in enumerate(arrays):
        made[index] = None if one is None else one.ctypes.data
    keep += [made, *arrays]
    return ctypes.addressof(made)
