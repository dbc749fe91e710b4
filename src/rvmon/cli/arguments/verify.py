"""The arguments of `rvmon verify`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import add_budget, declare


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "verify",
        description="Decide queries on a network of timed automata (.ta, or UPPAAL's .xml), each "
        "with a timed run that shows why. Exit code 0: all hold; 1: one does not, or the search "
        "stopped at a limit.",
        epilog="example: rvmon verify examples/models/train_gate.ta --query 'A[] not "
        "deadlock' --trace fastest",
    )
    add = parser.add_argument
    add("model", metavar="MODEL", help="a .ta or .xml file")
    add(
        "--query",
        metavar="Q",
        action="append",
        help="a query, or the id of one in the model (default: all)",
    )
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--spec",
        metavar="SPEC",
        help="check the requirements of a specification on all runs instead",
    )
    add(
        "--bind",
        metavar="NAME=EXPR",
        action="append",
        default=[],
        help="the expression of the model that a signal of the specification stands for",
    )
    instead.add_argument(
        "--suite",
        choices=("locations", "edges", "edge-pairs"),
        help="show a small set of runs that covers all of these instead",
    )
    add("--seed", metavar="N", type=int, default=1, help="random seed of simulated runs")
    add(
        "--trace",
        choices=("shortest", "fastest", "likely"),
        default="shortest",
        help="which of several runs to show (default: shortest)",
    )
    add(
        "--const", metavar="NAME=N", action="append", default=[], help="set a constant of the model"
    )
    declare(parser, "--format")
    add_budget(parser)
