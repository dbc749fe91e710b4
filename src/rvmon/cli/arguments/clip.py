"""The arguments of `rvmon clip`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import READING, declare
from rvmon.cli.parser import TIME_FORMS, span, ticks
from rvmon.cli.reading import ATTEMPT_HELP
from rvmon.trace.time import TICKS_PER_SECOND


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "clip",
        description="Cut a recording around an attempt, in the recording's own format. The last "
        "values of signals before the cut are carried to its start. The cut is evaluated again; "
        "the exit code is 1 if the attempt gets another verdict.",
        epilog="example: rvmon clip examples/base.rv examples/base.csv B2#2 --before 1s -o "
        "piece.csv",
    )
    add = parser.add_argument
    add("spec", metavar="SPEC", help="a .rv file")
    add("data", metavar="DATA", help="a recording, as `rvmon run` takes it")
    add("attempt", metavar="ID#N", nargs="?", help=ATTEMPT_HELP)
    add(
        "--before",
        metavar="TIME",
        type=span,
        default=10 * TICKS_PER_SECOND,
        help=f"start TIME ({TIME_FORMS}; default: 10s) before the trigger, or before the failure "
        "within an episode",
    )
    add(
        "--after",
        metavar="TIME",
        type=span,
        default=5 * TICKS_PER_SECOND,
        help=f"end TIME ({TIME_FORMS}; default: 5s) after the decision, or at the next sample if "
        "that is later",
    )
    add("--from", metavar="TIME", type=ticks, dest="start", help=f"first instant ({TIME_FORMS})")
    add("--to", metavar="TIME", type=ticks, dest="stop", help=f"last instant ({TIME_FORMS})")
    add("-o", "--out", metavar="FILE", help="the cut recording; a folder for a bag of ROS 2")
    add(
        "--reproducer",
        metavar="FILE",
        help="one file (.rvcase) with the cut recording and the specification: `rvmon why FILE` "
        "explains the attempt, `rvmon run FILE` evaluates it; -o FILE.rvcase is the same",
    )
    declare(parser, "--const", *READING, "--allow-missing")
