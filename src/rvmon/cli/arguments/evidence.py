"""The arguments of `rvmon evidence`."""

from __future__ import annotations

import argparse

from rvmon.cli.parser import positive


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments; whose tests are played again, a campaign says."""
    parser = subparsers.add_parser(
        "evidence",
        help="check an evidence archive",
        description="Check that an evidence archive (`--evidence FILE`) is unchanged and that "
        "the recordings are the evaluated ones, and evaluate a sample of them again. Exit codes: "
        "0 all checks passed, 1 one failed, 2 something could not be checked.",
        epilog="example: %(prog)s base.zip --sample all",
    )
    add = parser.add_argument
    add("file", metavar="FILE", help="the archive")
    add(
        "--sample",
        metavar="N",
        type=lambda text: None if text == "all" else positive(text),
        default=10,
        help="number of recordings or tests to evaluate again, or all (%(default)s)",
    )
    add("--seed", metavar="N", type=int, default=1, help="random seed of the sample (1)")
    add("--jobs", metavar="N", type=positive, default=1, help="number of processes (1)")
    parser.set_defaults(campaign=None)
