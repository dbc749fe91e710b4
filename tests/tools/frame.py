"""Where traces begin and end, by two reports."""

from __future__ import annotations

from rvmon.verdict.report import Report


def frame_differences(expected: Report, actual: Report) -> list[str]:
    """One line per disagreement on where the trace begins and ends."""
    return [
        f"{what} of the trace: {wanted}, got {got}"
        for what, wanted, got in (
            ("origin", expected.origin, actual.origin),
            ("end", expected.end, actual.end),
        )
        if wanted != got
    ]
