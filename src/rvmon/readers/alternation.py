"""Whether unknown values alternate with known ones, as in a merge of topics of several rates."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rvmon.trace.sample import Health, HealthKind, Value
from rvmon.trace.schema import is_unknown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

REMARK = (
    "alternates with values, as in a merge of topics; if it stands for no update, say so: "
    'nan="no update", rvmon run --nan no-update'
)
"""What is reported of a name that does."""

_LEAST = 3
"""Stretches of unknown values; fewer are dropouts."""

_SCALARS = frozenset({bool, int, float, str})
"""Of these types all values are known but NaN, which differs from itself."""

_LONGEST = 4
"""Known values of a stretch, on average, at most."""


@dataclass(slots=True)
class Alternation:
    """Known and unknown values of a name.

    Attributes:
        known: how many.
        unknown: how many.
        stretches: of unknown values.
        was_unknown: the last one.
    """

    known: int = 0
    unknown: int = 0
    stretches: int = 0
    was_unknown: bool = False

    def add(self, *, is_unknown: bool) -> None:
        """Take a value."""
        if is_unknown:
            self.unknown += 1
            self.stretches += not self.was_unknown
        else:
            self.known += 1
        self.was_unknown = is_unknown

    def add_known(self, count: int) -> None:
        """Take so many known values, one at least."""
        self.known += count
        self.was_unknown = False

    def add_all(self, unknown: NDArray[np.bool_]) -> None:
        """Take values in order: whether each is unknown; there is one."""
        count = int(unknown.sum())
        self.unknown += count
        self.known += len(unknown) - count
        self.stretches += int((unknown[1:] & ~unknown[:-1]).sum())
        self.stretches += bool(unknown[0]) and not self.was_unknown
        self.was_unknown = bool(unknown[-1])

    @property
    def is_merge(self) -> bool:
        """Whether at least half is unknown, and known values seldom follow each other."""
        return (
            self.stretches >= _LEAST
            and self.known <= self.unknown
            and 0 < self.known <= _LONGEST * self.stretches
        )


class Alternations:
    """Those of all names of a recording; payload fields are called `event.field`."""

    def __init__(self) -> None:
        self._found: dict[str, Alternation] = defaultdict(Alternation)

    def note(self, values: Mapping[str, Value]) -> None:
        """Look through a sample."""
        for name, value in values.items():
            if value.__class__ in _SCALARS and value == value:
                self._found[name].add_known(1)
            elif isinstance(value, Mapping):
                for field, scalar in value.items():
                    self._found[f"{name}.{field}"].add(is_unknown=is_unknown(scalar))
            elif not isinstance(value, tuple):
                self._found[name].add(is_unknown=is_unknown(value))

    def note_column(self, name: str, unknown: NDArray[np.bool_]) -> None:
        """Look through rows of a signal: whether its value is unknown in each; there is one."""
        self._found[name].add_all(unknown)

    def note_known(self, name: str, count: int) -> None:
        """Take so many rows of a signal in which its value is known."""
        self._found[name].add_known(count)

    def remarked(self, health: Iterable[Health]) -> tuple[Health, ...]:
        """The findings, with a remark at unknown values that look like a merge's."""
        return tuple(
            replace(one, remark=REMARK)
            if one.kind in (HealthKind.NAN, HealthKind.NONE)
            and (found := self._found.get(one.name)) is not None
            and found.is_merge
            else one
            for one in health
        )
