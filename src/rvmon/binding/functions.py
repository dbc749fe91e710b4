"""What is calculated of the fields of a message, besides the arithmetic of the language."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from rvmon.spec.checked.operators import BinaryOp


def yaw(x: float, y: float, z: float, w: float) -> float:
    """The turn about the upright axis that a quaternion of length 1 says, in radians.

    >>> round(yaw(0, 0, 0.7071067811865476, 0.7071067811865476), 9)
    1.570796327
    """
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def number(text: str | float) -> float | None:
    """The number that a text says; `None`, which is unknown, if it says none.

    >>> number("41.5"), number("n/a")
    (41.5, None)
    """
    try:
        return float(text)
    except ValueError:
        return None


def least(values: Iterable[float]) -> float | None:
    """The least of numbers but those that are NaN; `None` if there is none.

    >>> least([2.0, float("nan"), 1.5]), least([])
    (1.5, None)
    """
    return min(_known(values), default=None)


def greatest(values: Iterable[float]) -> float | None:
    """The greatest of numbers but those that are NaN; `None` if there is none."""
    return max(_known(values), default=None)


def _known(values: Iterable[float]) -> list[float]:
    listed = values.tolist() if isinstance(values, np.ndarray) else values
    return [value for value in listed if value == value]


def some(values: Iterable[float], *, holds: Callable[[float, float], bool], limit: float) -> Any:
    """Whether a comparison holds of an element; unknown if of none that is known, and one is not.

    >>> some([2.0, 0.1], holds=operator.lt, limit=0.3), some([], holds=operator.lt, limit=0.3)
    (True, False)
    """
    known = _known(values)
    if any(holds(value, limit) for value in known):
        return True
    return False if len(known) == len(list(values)) else None


def every(values: Iterable[float], *, holds: Callable[[float, float], bool], limit: float) -> Any:
    """Whether a comparison holds of all elements; unknown if it does but for unknown ones."""
    known = _known(values)
    if not all(holds(value, limit) for value in known):
        return False
    return True if len(known) == len(list(values)) else None


CONNECTIVES: Mapping[BinaryOp, Callable[[float, float], bool]] = {
    BinaryOp.AND: lambda first, second: bool(first) and bool(second),
    BinaryOp.OR: lambda first, second: bool(first) or bool(second),
    BinaryOp.XOR: operator.ne,
}
"""The connectives of a value."""
