"""`rvmon compare`: what has changed between two files of verdicts."""

from __future__ import annotations

import argparse
from itertools import groupby
from typing import TYPE_CHECKING

from rvmon.cli.output import busy, say_json
from rvmon.verdicts.compare import Change, Comparison, Difference, compare
from rvmon.verdicts.table_file import read_results

if TYPE_CHECKING:
    from rich.console import Console


LISTED = 20
"""Differences of one kind that the text lists."""


def run(arguments: argparse.Namespace) -> int:
    """Read, compare, show, and return the exit code."""
    with busy("comparing verdicts"):
        comparison = compare(read_results(arguments.before), read_results(arguments.after))
    if arguments.format == "json":
        say_json(_json(comparison))
    else:
        from rvmon.report.terminal import Terminal

        _print(comparison, Terminal(), None if arguments.all else LISTED)
    return int(any(difference.change.is_loss for difference in comparison.differences))


def _json(comparison: Comparison) -> str:
    import msgspec

    return msgspec.json.encode(comparison).decode()


def _print(comparison: Comparison, console: Console, most: int | None) -> None:
    for change, group in groupby(comparison.differences, key=lambda difference: difference.change):
        _print_kind(change, list(group), console, most)
    failing = sum(map(len, comparison.failing.values()))
    for names, where in (
        (comparison.only_before, "only in the earlier"),
        (comparison.only_after, "only in the later"),
    ):
        if names:
            rest = f" and {len(names) - 3:,} more" if len(names) > 3 else ""
            console.print(f"{where}: {', '.join(names[:3])}{rest}", style="dim", markup=False)
    fail = f", {failing:,} of them still fail" if failing else ""
    console.print(f"{comparison.same:,} verdicts are as before{fail}")


def _print_kind(
    change: Change, differences: list[Difference], console: Console, most: int | None
) -> None:
    from rich.text import Text

    from rvmon.report.wording import wrapped

    style = "bold red" if change.is_loss else "bold green" if change.is_gain else "bold"
    console.print(Text(f"{len(differences):,} {change.value}:", style=style))
    for difference in differences[:most]:
        console.print(Text(wrapped(_line(difference), console.width)))
    if most is not None and len(differences) > most:
        console.print(f"  … and {len(differences) - most:,} more: --all lists them", style="dim")


def _line(difference: Difference) -> str:
    from rvmon.report.wording import in_short

    if difference.before is None or difference.after is None:
        cause = in_short(difference.reason)
        return f"{difference.recording}: {cause}" if cause else difference.recording
    before, after = difference.failures
    counts = f" ({before:,} → {after:,} failures)" if max(before, after) > 1 else ""
    reason = f": {difference.reason}" if difference.reason and after else ""
    what = f"{difference.requirement} in {difference.recording}"
    return f"{what}: {difference.before} → {difference.after}{counts}{reason}"
