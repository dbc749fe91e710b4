"""A compiled monitor as a function over columns."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rvmon.codegen.c_build import built
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_source import c_files
from rvmon.codegen.c_tables import DECISIONS, VERDICTS
from rvmon.codegen.plan import Plan
from rvmon.errors import RvmonError
from rvmon.verdict.attempt import Attempt

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NOTHING, NO, UNKNOWN, YES = range(4)
"""What a row says of a name."""

WHERE_IT_ENDS = -(1 << 63)


@dataclass(frozen=True, slots=True)
class Column:
    """One signal, event or payload field.

    Attributes:
        states: uint8[n], what each row says; of a field, left out.
        values: float64[n]: booleans as 0 and 1, labels by number; of an event, left out.
    """

    states: NDArray[np.uint8] | None = None
    values: NDArray[np.float64] | None = None


@dataclass(frozen=True, slots=True)
class Judged:
    """What a batch found.

    Attributes:
        attempts: the records, without reasons, in the order in which they were made.
        end: the last instant of the trace; `None` if it has none.
        rows: the rows that were taken; fewer than given if one was out of order.
    """

    attempts: tuple[Attempt, ...]
    end: int | None
    rows: int


class _Record(ctypes.Structure):
    _fields_ = (
        ("requirement", ctypes.c_int32),
        ("number", ctypes.c_uint32),
        ("triggered", ctypes.c_int64),
        ("decided", ctypes.c_int64),
        ("verdict", ctypes.c_uint8),
        ("decision", ctypes.c_uint8),
    )


class _In(ctypes.Structure):
    _fields_ = (
        ("n", ctypes.c_int64),
        ("t", ctypes.c_void_p),
        ("advance", ctypes.c_void_p),
        ("signal", ctypes.c_void_p),
        ("value", ctypes.c_void_p),
        ("event", ctypes.c_void_p),
        ("field", ctypes.c_void_p),
        ("absent", ctypes.c_void_p),
        ("until", ctypes.c_int64),
        ("records", ctypes.c_void_p),
        ("capacity", ctypes.c_int64),
    )


def _out_type(rules: int) -> type[ctypes.Structure]:
    class Out(ctypes.Structure):
        _fields_ = (
            ("records", ctypes.c_int64),
            ("rows", ctypes.c_int64),
            ("end", ctypes.c_int64),
            ("overflow", ctypes.c_bool),
            ("verdict", ctypes.c_uint8 * max(rules, 1)),
        )

    return Out


class BatchLibrary:
    """A plan compiled to a shared library.

    Args:
        plan: of requirements that all have automata.

    Raises:
        RvmonError: there is no C compiler, or a requirement has no automaton.
    """

    def __init__(self, plan: Plan) -> None:
        self.names = Names(plan)
        self.plan = plan
        made = c_files(plan)
        sources = [f"{made.prefix}.c", f"{made.prefix}_batch.c"]
        path = built(made.texts, sources, ".so", ["-shared", "-fPIC"])
        library = ctypes.CDLL(str(path))
        self._batch = library[f"{made.prefix}_batch"]
        self._batch.restype = ctypes.c_bool
        self._out = _out_type(len(plan.rules))
        result = ctypes.c_int64()
        sizes = library[f"{made.prefix}_sizes"]
        sizes.restype = ctypes.c_int64
        if (sizes(ctypes.byref(result)), result.value) != (
            ctypes.sizeof(_Record),
            ctypes.sizeof(self._out),
        ):
            raise RvmonError("the C compiler lays out records otherwise than Python does")

    def judge(
        self,
        times: NDArray[np.int64],
        columns: Mapping[str, Column],
        *,
        absent: frozenset[str] = frozenset(),
        until: int | None = None,
        advances: NDArray[np.uint8] | None = None,
    ) -> Judged:
        """Judge one recording.

        Args:
            times: int64[n] ticks, strictly increasing.
            columns: by signal, event, and `event.field`; what is left out never comes.
            absent: the names without a source.
            until: the end of the trace, if it is after all rows.
            advances: uint8[n], 1 where a row is no sample but says how far time has come.

        Raises:
            RvmonError: memory ran out, or a static capacity.
        """
        import numpy as np

        plan, names = self.plan, self.names
        keep: list[Any] = [times, advances]
        flags = np.zeros(max(len(plan.signals) + len(plan.events), 1), np.uint8)
        for name in absent:
            flags[names.number(name)] = 1
        fields = [f"{event}.{field}" for event, field in names.fields]
        given = _In(
            n=len(times),
            t=times.ctypes.data,
            advance=None if advances is None else advances.ctypes.data,
            signal=_pointers([columns.get(name, Column()).states for name in plan.signals], keep),
            value=_pointers([columns.get(name, Column()).values for name in plan.signals], keep),
            event=_pointers([columns.get(name, Column()).states for name in plan.events], keep),
            field=_pointers([columns.get(name, Column()).values for name in fields], keep),
            absent=flags.ctypes.data,
            until=WHERE_IT_ENDS if until is None else until,
        )
        out = self._out()
        capacity = 1024
        while True:
            records = (_Record * capacity)()
            given.records, given.capacity = ctypes.addressof(records), capacity
            if not self._batch(ctypes.byref(given), ctypes.byref(out)):
                raise RvmonError("not enough memory for the open attempts")
            if out.records <= capacity:
                break
            capacity = out.records
        if out.overflow:
            raise RvmonError("the capacity of a past operator is too small for this recording")
        attempts = tuple(self._attempt(record) for record in records[: out.records])
        return Judged(attempts, None if out.end == WHERE_IT_ENDS else out.end, out.rows)

    def _attempt(self, record: _Record) -> Attempt:
        decision = DECISIONS[record.decision]
        return Attempt(
            self.plan.rules[record.requirement].requirement.id,
            record.number,
            record.triggered,
            None if decision is DECISIONS[3] else record.decided,
            VERDICTS[record.verdict],
            decision,
        )


def _pointers(arrays: Sequence[NDArray[Any] | None], keep: list[Any]) -> int:
    """The address of an array of the addresses of arrays."""
    made = (ctypes.c_void_p * max(len(arrays), 1))()
    for index, one in enumerate(arrays):
        made[index] = None if one is None else one.ctypes.data
    keep += [made, *arrays]
    return ctypes.addressof(made)
