"""The arguments of `rvmon conform`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import add_budget, declare
from rvmon.cli.parser import TIME_FORMS, span


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "conform",
        description="Decide whether recordings (.csv, .jsonl) are runs of a network of timed "
        "automata; their events are labels of its edges, or its channels. The first sample is "
        "the network's start. Exit code 0: all conform; 1: one does not, or is not decided; 2: a "
        "recording cannot be read, or holds no action of the model.",
        epilog="example: rvmon conform examples/models/dock.ta examples/models/dock_monday.csv",
    )
    add = parser.add_argument
    add("model", metavar="MODEL", help="a .ta or .xml file")
    add("traces", metavar="TRACE", nargs="+", help="recordings, or folders of recordings")
    declare(parser, "--time")
    add(
        "--observe",
        metavar="LABELS",
        help="labels that are observed (default: those that have a column, or that occur)",
    )
    add(
        "--tolerance",
        metavar="TIME",
        type=span,
        default=0,
        help=f"by how much an action may be early or late ({TIME_FORMS}; default: 0)",
    )
    add(
        "--until",
        metavar="TIME",
        type=span,
        help=f"compare up to TIME ({TIME_FORMS}) after the first sample, whether or not the "
        "recording goes on that long",
    )
    declare(parser, "--format")
    add_budget(parser)
