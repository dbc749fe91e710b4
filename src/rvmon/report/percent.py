"""Figures for people: counts of things, and percentages that never claim more than is so."""

from __future__ import annotations

SMALLEST = 0.1


def percent(part: int, whole: int) -> float:
    """A share in percent with one decimal; 0 and 100 only where exactly none or all.

    Args:
        part: how many of `whole`.
        whole: at least 1; of nothing, all is covered.

    >>> percent(1, 3), percent(1, 5000), percent(4999, 5000), percent(7, 7)
    (33.3, 0.1, 99.9, 100.0)
    """
    if part == whole:
        return 100.0
    if part == 0:
        return 0.0
    return min(max(round(100 * part / whole, 1), SMALLEST), 100 - SMALLEST)


def percent_text(part: float, whole: float) -> str:
    """The same in whole percent, for people.

    >>> percent_text(2, 3), percent_text(1, 5000), percent_text(4999, 5000)
    ('67 %', '< 1 %', '> 99 %')
    """
    if part in (0, whole):
        return "0 %" if part == 0 and whole else "100 %"
    rounded = round(100 * part / whole)
    if rounded == 0:
        return "< 1 %"
    return "> 99 %" if rounded == 100 else f"{rounded} %"


def counted(count: int, noun: str) -> str:
    """A number of things.

    >>> counted(1, "test"), counted(2000, "test")
    ('1 test', '2,000 tests')
    """
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def share_text(share: float) -> str:
    """A share for people, that claims neither none nor all where that is not so.

    >>> share_text(0.99999), share_text(0.5)
    ('> 99 %', '50 %')
    """
    return percent_text(share, 1)
