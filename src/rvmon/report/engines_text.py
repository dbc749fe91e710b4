"""Which engine judges what, as a table for the terminal and as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from rvmon.diagnostics.shown import shown_line
from rvmon.monitor.engines.choice import EngineChoice
from rvmon.report.plain_table import plain_table

_HEAD = ("", "online", "recording", "why not another")

_OF_C = "the engine c is taken by name only: it makes no snapshots"


def engines_text(choices: Mapping[str, EngineChoice]) -> str:
    """A line per requirement: what `auto` takes, and what faster engines refuse.

    Below them why `c` is not taken, which refuses nothing.
    """
    rows = [
        (shown_line(name), choice.online, choice.recording, _why(choice))
        for name, choice in choices.items()
    ]
    return plain_table([_HEAD, *rows]) + _OF_C


def _why(choice: EngineChoice) -> str:
    """The engines by what they refuse."""
    by_reason: dict[str, list[str]] = {}
    for name, refusal in choice.refused.items():
        by_reason.setdefault(refusal.reason, []).append(name)
    reasons = [f"{', '.join(names)}: {reason}" for reason, names in by_reason.items()]
    return shown_line("; ".join(reasons))


def engines_data(choices: Mapping[str, EngineChoice]) -> dict[str, Any]:
    """The same as plain data."""
    return {name: asdict(choice) for name, choice in choices.items()}
