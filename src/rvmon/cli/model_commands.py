"""The arguments of the commands about models and of the export, apart from their work."""

from __future__ import annotations

from rvmon.cli.options import ONLY, add_budget, declare
from rvmon.cli.parser import TIME_FORMS, Subparsers, span


def add_verify(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon verify`."""
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
    parser.option("--seed N", "random seed of simulated runs", type=int, default=1)
    parser.option(
        "--trace",
        "which of several runs to show (default: shortest)",
        choices=("shortest", "fastest", "likely"),
        default="shortest",
    )
    add(
        "--const", metavar="NAME=N", action="append", default=[], help="set a constant of the model"
    )
    declare(parser, "--format")
    add_budget(parser)


def add_conform(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon conform`."""
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
    parser.option(
        "--observe LABELS",
        "labels that are observed (default: those that have a column, or that occur)",
    )
    parser.option(
        "--tolerance TIME",
        f"by how much an action may be early or late ({TIME_FORMS}; default: 0)",
        type=span,
        default=0,
    )
    parser.option(
        "--until TIME",
        f"compare up to TIME ({TIME_FORMS}) after the first sample, whether or not the "
        "recording goes on that long",
        type=span,
    )
    declare(parser, "--format")
    add_budget(parser)


def add_export(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon export`."""
    parser = subparsers.add_parser(
        "export",
        description="Of a specification, write a monitor that does not need rvmon: C99 sources "
        "(the core, the compiled specification, a header for C++) that run in one block of "
        "memory. Or write its automata: dot for Graphviz, json, hoa (the minimal LTL3 monitors "
        "of requirements without time windows). Of a model, write dot, or XML for UPPAAL.",
        epilog="examples: rvmon export examples/base.rv --to c -o monitor/; rvmon export "
        "examples/base.rv --to dot --only B1 | dot -Tsvg -o b1.svg; rvmon export "
        "examples/models/fischer.ta --to uppaal -o fischer.xml",
    )
    add = parser.add_argument
    add("subject", metavar="SPEC|MODEL", help="a .rv file; or a .ta or .xml file")
    add("--to", choices=("c", "dot", "json", "hoa", "uppaal"), required=True)
    parser.option("-o --output PATH", "output folder (c) or file (default: standard output)")
    declare(parser, *ONLY, "--const")
