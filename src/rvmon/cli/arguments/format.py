"""The arguments of `rvmon format`."""

from __future__ import annotations

import argparse


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "format",
        description="Rewrite specifications in the canonical layout; meaning and comments are "
        "kept. With - as SPEC, standard input is formatted to standard output.",
        epilog="example: rvmon format --check specs/*.rv",
    )
    parser.add_argument("specs", metavar="SPEC", nargs="+", help=".rv files")
    parser.add_argument(
        "--check", action="store_true", help="do not write; exit with 1 if a file would change"
    )
