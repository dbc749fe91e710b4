"""The arguments of `rvmon compare`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import declare


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "compare",
        description="Compare the verdicts on recordings with earlier ones, by recording and "
        "requirement: new failures, fixed failures, verdicts that are missing now. The files are "
        "written by `rvmon run --out` (.csv, .parquet, .sqlite) or `--format json` (.json). The "
        "exit code is 1 if a requirement got worse.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv --out old.csv; rvmon "
        "compare old.csv old.csv",
    )
    add = parser.add_argument
    add("before", metavar="OLD", help="the earlier verdicts")
    add("after", metavar="NEW", help="the later verdicts")
    add("--all", action="store_true", help="list all differences")
    declare(parser, "--format")
