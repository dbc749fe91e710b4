"""From a random case that shows something to a small one, by fewer and smaller choices."""

from collections.abc import Callable, Sequence
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
        return self._made(k, lambda: super(_Choices, self).getrandbits(k))

    def random(self) -> float:
        drawn = self._made(_BITS, lambda: int(super(_Choices, self).random() * 2**_BITS))
        return float(drawn / 2**_BITS)

    def _made(self, bits: int, of_seed: Callable[[], int]) -> int:
        place = len(self.made)
        if place > _MOST_CHOICES:
            raise OverflowError
        if self._wanted is None:
            drawn = of_seed()
        else:
            drawn = (self._wanted[place] if place < len(self._wanted) else 0) & ((1 << bits) - 1)
        self.made.append(drawn)
        return drawn


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
            head, one, tail = choices[:at], choices[at], choices[at + 1 :]
            less = [(one // 2, 0), *((one - 1, skipped) for skipped in range(40))] if one else []
            at += not any(helps([*head, value, *tail[skipped:]]) for value, skipped in less)
    return best
