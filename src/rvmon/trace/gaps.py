"""What stands for "no update" in a recording, besides what is absent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rvmon.errors import UnknownNameError

READINGS_OF_NAN = ("unknown", "no update")
"""What NaN may say of a name: that it became unknown, or nothing."""


@dataclass(frozen=True, slots=True)
class Gaps:
    """Values that say nothing of their name.

    Attributes:
        no_update: a value; `None`: no further one.
        nan: whether NaN is one.
    """

    no_update: bool | int | float | str | None = None
    nan: bool = False

    def __bool__(self) -> bool:
        return self.nan or self.no_update is not None

    @property
    def reading_of_nan(self) -> str:
        """One of `READINGS_OF_NAN`."""
        return READINGS_OF_NAN[self.nan]

    def holds(self, value: Any) -> bool:
        """Whether a value of a cell, or of a sample, says nothing.

        >>> Gaps(no_update=-1).holds(-1.0), Gaps(no_update=1).holds(True), Gaps(nan=True).holds(2)
        (True, False, False)
        """
        if isinstance(value, float) and value != value:
            return self.nan
        if self.no_update is None or not isinstance(value, bool | int | float | str):
            return False
        same_kind = isinstance(value, bool) == isinstance(self.no_update, bool)
        return same_kind and value == self.no_update


def is_unknown(value: Any) -> bool:
    """Whether the value of a sample is none: NaN, or nothing."""
    return value is None or (isinstance(value, float) and value != value)


NO_GAPS = Gaps()
"""Only what is absent says nothing."""


def gaps_of(nan: str, no_update: Any) -> Gaps:
    """What a caller names.

    Args:
        nan: one of `READINGS_OF_NAN`.
        no_update: a value, NumPy's too; NaN is as good as `nan="no update"`; `None`: no further.

    Raises:
        UnknownNameError: there is no such reading of NaN, or the value is none that a cell holds.
    """
    if nan not in READINGS_OF_NAN:
        known = " or ".join(f"nan={one!r}" for one in READINGS_OF_NAN)
        raise UnknownNameError(f"no reading of NaN {nan!r}: there is {known}")
    value = no_update.item() if hasattr(no_update, "item") else no_update
    if not isinstance(value, bool | int | float | str | None):
        raise UnknownNameError(
            f"no_update={no_update!r} is no value of a cell: give a number, a text or a truth value"
        )
    if value is not None and value != value:
        return Gaps(nan=True)
    return Gaps(value, nan == READINGS_OF_NAN[True])
