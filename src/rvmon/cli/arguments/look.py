"""The arguments of `rvmon look`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import READING, declare


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "look",
        description="Show every signal and event of a recording over time: kind, unit, rate, "
        "longest gap, range and losses. With a specification, the signals and events that its "
        "requirements read come first.",
        epilog="examples: rvmon look examples/base.csv; "
        "rvmon look examples/base.csv examples/base.rv -o look.html",
    )
    add = parser.add_argument
    add("data", metavar="DATA", help="a recording, as `rvmon run` takes it")
    add("spec", metavar="SPEC", nargs="?", help="a .rv file")
    add("-o", "--output", metavar="FILE", help="write an HTML page instead")
    declare(parser, "--const", *READING)
