"""The arguments of `rvmon export`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import ONLY, declare


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
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
    add(
        "-o",
        "--output",
        metavar="PATH",
        help="output folder (c) or file (default: standard output)",
    )
    declare(parser, *ONLY, "--const")
