"""The arguments of `rvmon check`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import declare
from rvmon.cli.parser import TIME_FORMS, span_s


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "check",
        description="Report all errors and warnings of each specification.",
        epilog="examples: rvmon check examples/base.rv; rvmon check specs/*.rv --format concise",
    )
    add = parser.add_argument
    add("specs", metavar="SPEC", nargs="+", help=".rv files, - for standard input")
    declare(parser, "--const", "--binding")
    add(
        "--format",
        choices=("text", "concise", "json"),
        default="text",
        help="how to print findings: in full, one line each, or as JSON, which has a line for each "
        "as well (default: text)",
    )
    add("--strict", action="store_true", help="exit with 1 if there are warnings")
    add(
        "--analyse",
        action="store_true",
        help="look for requirements that can never trigger, fail or pass, that conflict, or that "
        "others imply",
    )
    add(
        "--seconds",
        metavar="TIME",
        type=span_s,
        default=8.0,
        help=f"budget of --analyse per file ({TIME_FORMS}; default: 8)",
    )
    declare(parser, "--max-memory")
