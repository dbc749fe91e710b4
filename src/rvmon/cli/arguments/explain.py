"""The arguments of `rvmon explain`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import declare
from rvmon.cli.parser import positive


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "explain",
        description="Explain a requirement: in plain words, with its automaton and the shortest "
        "runs on which it passes, fails, is not triggered or stays open. Of two requirements, "
        "show where they differ. Of a diagnostic code such as RV012, show its page; `codes` "
        "lists all codes.",
        epilog="examples: rvmon explain examples/base.rv B2; rvmon explain RV001",
    )
    add = parser.add_argument
    add("subject", metavar="SPEC|CODE", help="a .rv file, or a code such as RV012")
    add("ids", metavar="ID", nargs="*", help="one requirement, or two (default: all)")
    declare(parser, "--const")
    add(
        "--runs",
        metavar="N",
        type=positive,
        default=4000,
        help="number of short runs to try (default: 4000)",
    )
    declare(parser, "--max-memory")
