"""`rvmon compare`: show the changes between two files of verdicts."""

from __future__ import annotations

import argparse
from itertools import groupby

from rvmon.cli.output import busy, say_json
from rvmon.errors import RvmonError
from rvmon.report.printer import Printer
from rvmon.report.wording import in_short, wrapped
from rvmon.texts import counted
from rvmon.verdicts.compare import Change, Comparison, Difference, compare
from rvmon.verdicts.table_file import read_results

LISTED = 20  # the most differences of one kind that the text lists


def run_compare(arguments: argparse.Namespace) -> int:
    """Compare two files, print the differences, and return the exit code."""
    with busy("comparing verdicts"):
        comparison = compare(read_results(arguments.before), read_results(arguments.after))
    only = comparison.only_before or comparison.only_after
    if only and not (comparison.same or comparison.differences):
        raise RvmonError(
            f"{arguments.before} and {arguments.after} have no requirement on a recording in "
            f"common, and {only[0]} is in only one of them: nothing was compared"
        )
    if arguments.format == "json":
        import msgspec

        say_json(msgspec.json.encode(comparison).decode())
    else:
        _print(comparison, Printer(), None if arguments.all else LISTED)
    return int(any(difference.change.is_loss for difference in comparison.differences))


def _print(comparison: Comparison, printer: Printer, most: int | None) -> None:
    for change, group in groupby(comparison.differences, key=lambda difference: difference.change):
        _print_kind(change, list(group), printer, most)
    failing = sum(map(len, comparison.failing.values()))
    for names, where in (
        (comparison.only_before, "only in the earlier"),
        (comparison.only_after, "only in the later"),
    ):
        if names:
            rest = f" and {len(names) - 3:,} more" if len(names) > 3 else ""
            printer.sentences(f"{where}: {', '.join(names[:3])}{rest}", "dim")
    fail = f", {failing:,} of them still fail" if failing else ""
    printer.line(f"{counted(comparison.same, 'verdict')} as before{fail}")


def _print_kind(
    change: Change, differences: list[Difference], printer: Printer, most: int | None
) -> None:
    style = "bold red" if change.is_loss else "bold green" if change.is_gain else "bold"
    printer.line((f"{len(differences):,} {change.value}:", style))
    for difference in differences[:most]:
        printer.line(wrapped(_line(difference), printer.width))
    if most is not None and len(differences) > most:
        printer.line((f"  … and {len(differences) - most:,} more: --all lists them", "dim"))


def _line(difference: Difference) -> str:
    if difference.before is None or difference.after is None:
        cause = in_short(difference.reason)
        return f"{difference.recording}: {cause}" if cause else difference.recording
    before, after = difference.failures
    counts = f" ({before:,} → {after:,} failures)" if max(before, after) > 1 else ""
    reason = f": {difference.reason}" if difference.reason and after else ""
    what = f"{difference.requirement} in {difference.recording}"
    return f"{what}: {difference.before} → {difference.after}{counts}{reason}"
