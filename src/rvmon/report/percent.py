"""Percentages that never claim more than is so."""

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
