"""Instants of an example as short labels."""

from __future__ import annotations

from rvmon.spec.print.printer import format_duration


def label_of(t: int) -> str:
    """An instant; one that is a tick beside a rounder one takes a sign for that.

    >>> label_of(3_000_000_001), label_of(199_999_999), label_of(0), label_of(1_500_000_000)
    ('3 s⁺', '200 ms⁻', '0 s', '1500 ms')
    """
    if t < 1000 or not (t + 1) % 1000:
        return f"{format_duration(t + 1)}⁻" if t >= 1000 else format_duration(t)
    return f"{format_duration(t - 1)}⁺" if t % 1000 == 1 else format_duration(t)


def legend_of(labels: list[str]) -> str:
    """What the signs in some labels mean, or empty."""
    signs = {"⁺": "after", "⁻": "before"}
    used = [
        f"{sign} a tick {word}" for sign, word in signs.items() if any(sign in x for x in labels)
    ]
    return ", ".join(used)
