"""Leaves of state formulas on whole columns, a truth per row."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np

from rvmon.spec.checked.arithmetic import Operation
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateValue,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Bits = NDArray[np.bool_]

Columns = Mapping[str, "NDArray[Any]"]


class NotByColumnsError(Exception):
    """Something of the trace, or of the specification, has to be judged sample by sample."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Kleene's truth, per row or as stretches.

    Attributes:
        must: where it is true.
        may: where it is not false; the same object where all is known.
    """

    must: Any
    may: Any

    @property
    def known(self) -> bool:
        """Whether nothing is unknown."""
        return self.must is self.may


def known_truth(must: Any) -> Truth:
    """A truth of which nothing is unknown."""
    return Truth(must, must)


def negated(truth: Truth, complement: Callable[[Any], Any]) -> Truth:
    """Kleene's `not`."""
    if truth.known:
        return known_truth(complement(truth.must))
    return Truth(complement(truth.may), complement(truth.must))


def combined(truths: Sequence[Truth], combine: Callable[[list[Any]], Any]) -> Truth:
    """Kleene's `and` or `or`."""
    must = combine([truth.must for truth in truths])
    if all(truth.known for truth in truths):
        return known_truth(must)
    return Truth(must, combine([truth.may for truth in truths]))


def compared(leaf: Compare, columns: Columns, rows: int) -> Truth:
    """The truth of a comparison of numbers per row.

    Args:
        leaf: reads present values of signals only.
        columns: the signals that have a source; NaN is unknown.
        rows: their length.

    Raises:
        NotByColumnsError: it reads something else, or its numbers are too large for arrays.
    """
    with np.errstate(all="ignore"):
        left, right = _number(leaf.left, columns), _number(leaf.right, columns)
        must = np.broadcast_to(leaf.op.holds(left, right), rows)
        unknown = reduce(np.logical_or, [_unknown(left), _unknown(right)])
    if unknown is False or not np.any(unknown):
        return known_truth(must)
    return Truth(must & ~unknown, must | unknown)


def _unknown(values: Any) -> Any:
    """Where numbers are NaN; mostly one sum shows that none is."""
    if not isinstance(values, np.ndarray) or values.dtype.kind != "f":
        return values != values
    if not np.isnan(np.add.reduce(values)):
        return False
    return np.isnan(values)


def _number(expression: Numeric, columns: Columns) -> Any:
    """The values per row, as Python would have them, or one for all."""
    match expression:
        case Literal(value=value):
            if isinstance(value, str):
                raise NotByColumnsError
            return value
        case SignalValue(name=name):
            if name not in columns:
                return np.nan
            return _as_python_compares(columns[name])
        case Arithmetic(op=op, args=args):
            values = [_number(arg, columns) for arg in args]
            if any(getattr(value, "dtype", np.dtype(float)).kind != "f" for value in values):
                raise NotByColumnsError  # integers of Python do not overflow
            made = _applied(op.entry, values)
            return np.where(np.isfinite(made), made, np.nan)
        case FieldValue() | Captured() | UpdateValue():
            raise NotByColumnsError
        case _:
            assert_never(expression)


def _applied(entry: Operation, values: Sequence[Any]) -> Any:
    if entry.numpy is None:
        rows = [one.tolist() for one in np.broadcast_arrays(*map(np.atleast_1d, values))]
        return np.array(list(map(entry.apply, *rows)))
    ufunc = getattr(np, entry.numpy)
    return reduce(ufunc, values) if len(values) > 1 else ufunc(values[0])


def _as_python_compares(values: NDArray[Any]) -> NDArray[Any]:
    """The values in a type in which they compare as Python's own do."""
    if values.dtype == np.float64:
        return values
    if values.dtype.kind == "f":
        return values.astype(np.float64)
    if values.dtype.kind != "i" or not (np.abs(values.astype(np.float64)) < 2**53).all():
        raise NotByColumnsError
    return values.astype(np.int64)
