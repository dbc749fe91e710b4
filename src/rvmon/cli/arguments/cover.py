"""The arguments of `rvmon cover`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import declare
from rvmon.cli.parser import percentage


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "cover",
        description="Show what the tests of one or several coverage databases have covered "
        "together: problems first, then groups, total and verdicts.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv --coverage base.cov; "
        "rvmon cover base.cov --holes",
    )
    add = parser.add_argument
    add("databases", metavar="DB", nargs="+", help="coverage databases, written by run --coverage")
    add("--campaign", metavar="NAME", help="show the tests of this campaign only")
    add(
        "--holes",
        action="store_true",
        help="list the items that are missing or cannot be hit, with the reasons",
    )
    add(
        "--bins",
        metavar="[=GROUP]",
        help="list the items of a group (default: of all), with hits and the first test that hit "
        "them; a cross is shown as a grid",
    )
    add(
        "--tests",
        action="store_true",
        help="list the tests with their contributions, and a short order that covers as much",
    )
    add(
        "--compare",
        metavar="OLD",
        help="show items and verdicts that changed since an earlier database, or an earlier "
        "campaign in this one",
    )
    declare(parser, "--format")
    add("--report", metavar="FILE", help="write an HTML page")
    add("--ucis", metavar="FILE", help="write the coverage as UCIS XML, for other tools")
    add("--merge", metavar="OUT", help="merge the databases into this one")
    add(
        "--require",
        metavar="PERCENT",
        type=percentage,
        help="exit with 1 if less is covered, or if an illegal item, or one declared "
        "unreachable, was hit",
    )
    add(
        "--strict",
        action="store_true",
        help="exit with 1 if an illegal item, or one declared unreachable, was hit, if a test "
        "failed or did not complete, or if --compare shows a loss",
    )
    declare(parser, "--max-memory")
