"""The arguments of `rvmon why`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import EVALUATED, declare
from rvmon.cli.reading import ATTEMPT_HELP


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "why",
        description="Explain one attempt: show when each part of its requirement was true.",
        epilog="example: rvmon why examples/base.rv examples/base.csv B2#2",
    )
    add = parser.add_argument
    add(
        "spec",
        metavar="SPEC",
        help="a .rv file, or a reproducer (.rvcase) that contains the other arguments",
    )
    add("trace", metavar="TRACE", help="a recording, as `rvmon run` takes it")
    add("attempt", metavar="ID#N", help=ATTEMPT_HELP)
    declare(parser, *EVALUATED, "--format")
