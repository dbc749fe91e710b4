"""`rvmon cover`: show the coverage of the tests in databases."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon import __version__
from rvmon.cli.options import refuse_over
from rvmon.cli.output import busy, say, say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.files import write_file
from rvmon.texts import did_you_mean

if TYPE_CHECKING:
    from rvmon.coverage import Coverage, Group
    from rvmon.report.coverage_summary import Summary


def run_cover(arguments: argparse.Namespace) -> int:
    """Read databases, print their coverage, and return the exit code."""
    from rvmon.coverage.database import merge, read
    from rvmon.report.coverage_summary import Summary

    refuse_over([arguments.report, arguments.ucis], [*arguments.databases, arguments.compare])
    with busy("reading databases"):
        # All are read before merging, so that contradictory models leave every file unchanged.
        coverage = read(arguments.databases)
        if arguments.merge is not None:
            merge(arguments.databases, arguments.merge)
    earlier = None if arguments.compare is None else _earlier(arguments, coverage)
    if arguments.campaign is not None:
        coverage = _campaign(coverage, arguments.campaign)
    name = ", ".join(arguments.databases)
    summary = Summary(name, coverage, earlier, arguments.compare or "")
    groups = _groups(coverage, arguments.bins)
    if arguments.report is not None:
        from rvmon.report.coverage_page import coverage_page

        write_file(arguments.report, coverage_page(summary))
    if arguments.ucis is not None:
        from rvmon.report.coverage_ucis import coverage_ucis

        write_file(arguments.ucis, coverage_ucis(summary, __version__))
    if arguments.format == "json":
        import msgspec

        from rvmon.report.coverage_summary import coverage_data

        say_json(msgspec.json.encode(coverage_data(summary)).decode())
    else:
        _print(summary, arguments, groups)
    return _code(summary, arguments)


def _earlier(arguments: argparse.Namespace, coverage: Coverage) -> Coverage:
    """The coverage to compare with: from a file, or of a campaign in the shown databases."""
    from rvmon.coverage.database import read

    if Path(arguments.compare).exists() or arguments.compare not in coverage.campaigns:
        return read([arguments.compare])
    if arguments.campaign is None:
        raise RvmonError(
            f"--compare {arguments.compare} is a campaign: name the one to compare it with by "
            "--campaign"
        )
    return _campaign(coverage, arguments.compare)


def _campaign(coverage: Coverage, name: str) -> Coverage:
    from rvmon.coverage.analysis import only

    known = coverage.campaigns
    if name not in known:
        listed = ", ".join(f"`{one}`" for one in known) or "none"
        meant = did_you_mean(name, known, f"there are {listed}")
        raise UnknownNameError(f"no campaign named `{name}`: {meant}")
    return only(coverage, lambda record: record.campaign == name)


def _groups(coverage: Coverage, name: str | None) -> Sequence[Group]:
    groups = coverage.model.groups
    if name is None:
        return ()
    if not name:
        return tuple(groups.values())
    if name not in groups:
        meant = did_you_mean(name, list(groups), f"there are {', '.join(groups) or 'none'}")
        raise UnknownNameError(f"no group named `{name}`: {meant}")
    return (groups[name],)


def _print(summary: Summary, arguments: argparse.Namespace, groups: Sequence[Group]) -> None:
    from rvmon.report.coverage_text import print_bins, print_holes, print_overview, print_tests
    from rvmon.report.printer import Printer

    printer = Printer()
    print_overview(summary, printer)
    if arguments.holes:
        print_holes(summary, printer)
    elif summary.holes and not groups:
        say("missing items: --holes")
    if groups:
        print_bins(summary, groups, printer)
    if arguments.tests:
        print_tests(summary, printer)


def _code(summary: Summary, arguments: argparse.Namespace) -> int:
    """The exit code: 1 if `--require` or `--strict` is not met."""
    is_held = arguments.strict or arguments.require is not None
    wrong = is_held and bool(summary.illegal or summary.contradicted)
    if arguments.require is not None:
        wrong |= summary.is_empty or summary.share < arguments.require
        if summary.is_empty:
            warn(
                "--require: there is nothing to cover: no model was declared, or all weights are 0"
            )
    if arguments.strict:
        wrong |= bool(summary.not_fine)
        wrong |= summary.comparison is not None and bool(summary.comparison.lost)
    return int(wrong)
