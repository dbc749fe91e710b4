"""From a random case that shows something to a small one, by fewer and smaller choices."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from random import Random
from typing import TypeVar

T = TypeVar("T")

_BITS = 53
"""Of `random()`."""

_MOST_CHOICES = 20_000
"""Of a case: who draws until something fits may never end on the least choices."""


class _Choices(Random):
    """Makes the choices that it is given, and then the least; or those of a seed.

    Attributes:
        made: all choices, as whole numbers of which the least is the simplest.
    """

    def __init__(self, wanted: Sequence[int] | None, seed: object) -> None:
        super().__init__(str(seed))
        self._wanted = wanted
        self.made: list[int] = []

    def getrandbits(self, k: int, /) -> int:
        drawn = super().getrandbits(k) if self._wanted is None else self._next() & ((1 << k) - 1)
        self.made.append(drawn)
        return drawn

    def random(self) -> float:
        drawn = (
            int(super().random() * 2**_BITS) if self._wanted is None else self._next() % 2**_BITS
        )
        self.made.append(drawn)
        return float(drawn / 2**_BITS)

    def _next(self) -> int:
        assert self._wanted is not None
        if len(self.made) > _MOST_CHOICES:
            raise OverflowError
        return self._wanted[len(self.made)] if len(self.made) < len(self._wanted) else 0


def shrink(
    draw: Callable[[Random], T], seed: object, shows: Callable[[T], bool], *, most: int = 1_500
) -> T:
    """What is drawn by fewer and smaller choices, and still shows what is looked for.

    Blocks of choices are left out or made the least, shorter and shorter ones; then each choice is
    lessened, also with some behind it left out; all that again as long as it helps.

    Args:
        draw: what the seed drew shows it.
        seed: of a `Random`, as text.
        shows: whether something drawn shows what is looked for.
        most: so many things are drawn.

    Source: MacIver and Donaldson, Test-Case Reduction via Test-Case Generation, ECOOP 2020.
    """
    first = _Choices(None, seed)
    best, choices, tried = draw(first), first.made, 0

    def helps(wanted: list[int]) -> bool:
        nonlocal best, choices, tried
        if tried >= most or wanted == choices:
            return False
        tried += 1
        source = _Choices(wanted, seed)
        try:
            drawn = draw(source)
        except (OverflowError, IndexError):  # nothing is drawn by these
            return False
        if (len(source.made), source.made) >= (len(choices), choices) or not shows(drawn):
            return False
        best, choices = drawn, source.made
        return True

    before: list[int] = []
    while before != choices:
        before = choices
        size = len(choices)
        while size:
            at = 0
            while at < len(choices):
                head, tail = choices[:at], choices[at + size :]
                if not helps(head + tail) and not helps([*head, *[0] * size, *tail]):
                    at += size
            size //= 2
        at = 0
        while at < len(choices):
            at += not any(map(helps, _lessened(choices, at)))
    return best


def _lessened(choices: list[int], at: int) -> Iterator[list[int]]:
    """One choice lessened; then some of those behind it may be needless, too."""
    one = choices[at]
    for less in (one // 2, one - 1) if one else ():
        yield [*choices[:at], less, *choices[at + 1 :]]
    for end in range(at + 2, min(at + 40, len(choices))) if one else ():
        yield [*choices[:at], one - 1, *choices[end:]]
