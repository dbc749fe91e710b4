"""The arguments of `rvmon init`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import declare


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "init",
        description="Write a starter specification from a recording: signals with guessed types, "
        "ranges and rates, events, and requirements that can be evaluated as they stand. With "
        "--for, propose a binding (TOML) that maps topics and fields of a bag or MCAP file to "
        "the names of a specification, by message type, unit and name, with the values that "
        "occur; names without a clear match are left open, and the exit code is then 1. With "
        "--campaign, write a test campaign that runs as it stands, to be adapted to your own "
        "system.",
        epilog="examples: rvmon init examples/base.csv -o mine.rv; rvmon init --campaign mine; "
        "rvmon init monday.bag --for base.rv > base.toml && rvmon run base.rv monday.bag --binding "
        "base.toml",
    )
    add = parser.add_argument
    add("data", metavar="DATA", nargs="?", help="a recording, as `rvmon run` takes it")
    add("--for", metavar="SPEC", dest="spec", help="propose a binding for this specification")
    declare(parser, "--const")
    add(
        "--campaign",
        metavar="DIR",
        help="write a campaign into this folder: code under test, its environment, requirements, "
        "strategies",
    )
    add(
        "-o",
        "--output",
        metavar="FILE",
        help="output file, - for standard output (default: the name of DATA, with .rv)",
    )
    declare(parser, "--time")
    add("--force", action="store_true", help="overwrite an existing file")
