"""One bound of the robustness of a formula while a trace goes by; its steps are generated.

Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze and Maler 2010; Deshmukh et al. 2017 (figures
of a part of a trace).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Self

from rvmon.dataflow.margin_end import End

Value = tuple[int, float]
"""A position, and the robustness there; or where a step begins, and its value."""

Letter = tuple[int, Sequence[float]]
"""A position, and what the leaves are from there on, in the order of the plan's leaves."""

Part = tuple[int, float, float, float, float]
"""First integer of a stretch; the least and the greatest value that it can have, whatever follows;
and the same given what has followed."""


class Gauge(ABC):
    """The robustness of a formula at the positions that it is asked for.

    `rvmon.codegen.python_margins` writes what derives from it.

    Args:
        first: the first position.

    Attributes:
        asked: the positions whose value is wanted, ascending; those that are answered are taken
            out.
        reported: the value that was reported last.

    Memory: what is not settled.
    """

    __slots__ = ("asked", "first", "reported")

    def __init__(self, first: int) -> None:
        self.first = first
        self.asked: list[int] = []
        self.reported = -float("inf")

    @abstractmethod
    def step(
        self, start: int, values: Sequence[float] | None, now: int, reached: int
    ) -> Sequence[Value]:
        """Let the leaves be known up to an integer.

        Args:
            start: from where on they have these values.
            values: in the order of the plan's leaves; `None`: they stay as they are.
            now: the integer.
            reached: the instant that time has come to, ticks.

        Returns:
            The values that are asked for and became settled, in order.
        """

    @abstractmethod
    def end(self, end: End, reached: int) -> Sequence[Value]:
        """End the trace, the leaves being known up to there; returns the values that are left.

        Args:
            end: of the trace.
            reached: the instant that time has come to.
        """

    def take(self, letters: Sequence[Letter], now: int, reached: int) -> Sequence[Value]:
        """As `step`, with all the letters that are new, in order and not behind `now`."""
        if len(letters) < 2:
            start, values = letters[0] if letters else (now, None)
            return self.step(start, values, now, reached)
        known = [start - 1 for start, _ in letters[1:]] + [now]
        steps = zip(letters, known, strict=True)
        return [one for letter, end in steps for one in self.step(*letter, end, reached)]

    def copy(self) -> Self:
        """The same, independent from now on."""
        made = type(self).__new__(type(self))
        for name in (*Gauge.__slots__, *self.__slots__):
            value = getattr(self, name)
            setattr(made, name, value.copy() if isinstance(value, deque | list) else value)
        return made

    def ask(self, position: int) -> None:
        """Want the value at a position of which the letter is not known yet."""
        asked = self.asked
        if not asked or asked[-1] < position:
            asked.append(position)

    def asks(self, left: int, right: int) -> bool:
        """Whether the value of some integer from `left` to `right` is wanted."""
        asked = self.asked
        index = bisect_left(asked, left)
        return index < len(asked) and asked[index] <= right

    # What steps call.

    def answers(self, news: Sequence[Value], known: int) -> Sequence[Value]:
        """What is asked for of a formula of which there is news, up to where it is known."""
        asked = self.asked
        if len(news) == 1 and asked[0] == known == news[0][0]:  # a stream, at most samples
            del asked[0]
            self.reported = news[0][1]
            return news
        found, index = [], 0
        for start, value in (*news, (known + 1, self.reported)):
            while index < len(asked) and asked[index] < start:
                found.append((asked[index], self.reported))
                index += 1
            if start <= known:
                self.reported = value
        del asked[:index]
        return found

    def hold(self, waiting: deque[Value], start: int, value: float) -> None:
        """Have another value wait; one before that nobody asks for may have any."""
        if waiting and not self.asks(waiting[-1][0], start - 1):
            start = waiting.pop()[0]
        waiting.append((start, value))

    def follow(self, parts: deque[Part], start: int, low: float, high: float, alone: bool) -> None:
        """Append a stretch of an `until`, U(i) = max(meets(i), min(stays(i), U(i + 1))), or a dual.

        Of a stretch, U is what follows, kept between two bounds; so it is of several stretches at
        once. A stretch whose bounds leave open all that what follows may be has the value of that
        and is joined to it: of `always` and `eventually` those remain that no later one betters.

        Args:
            parts: the stretches that are not settled.
            start: the first integer of the new one.
            low: the least that it can be.
            high: the greatest.
            alone: whether its value matters at positions that are asked for alone.
        """
        while parts:
            first, least, most, _, _ = parts[-1]
            leads_on = _within(low, least, most) == low and _within(high, least, most) == high
            if not leads_on and (not alone or self.asks(first, start - 1)):
                break
            parts.pop()
            if leads_on or not parts:
                start = first
                continue
            before, its_least, its_most, _, _ = parts.pop()
            least, most = _within(least, its_least, its_most), _within(most, its_least, its_most)
            parts.append((before, least, most, least, most))
        parts.append((start, low, high, low, high))
        for index in range(len(parts) - 2, -1, -1):
            first, least, most, low_now, high_now = parts[index]
            low, high = _within(low, least, most), _within(high, least, most)
            if (low, high) == (low_now, high_now):
                break
            parts[index] = (first, least, most, low, high)

    @staticmethod
    def ended(parts: Sequence[Part], value: float, right: int) -> Iterator[tuple[int, float, int]]:
        """The stretches of an `until` when all has ended: first integer, value, last integer.

        Args:
            parts: those that were not settled.
            value: behind the end.
            right: the last integer.
        """
        found = []
        for start, least, most, _, _ in reversed(parts):
            value = _within(value, least, most)
            found.append((start, value, right))
            right = start - 1
        return reversed(found)


def _within(value: float, least: float, most: float) -> float:
    return least if value < least else most if value > most else value
