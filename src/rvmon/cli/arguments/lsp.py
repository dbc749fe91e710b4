"""The arguments of `rvmon lsp`."""

from __future__ import annotations

import argparse


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "lsp",
        description="Serve an editor over standard input and output by the Language Server "
        "Protocol: findings, explanations, definitions, names and units, layout. It ends when the "
        "editor does.",
        epilog="example: rvmon lsp --stdio",
    )
    parser.add_argument(
        "--stdio", action="store_true", help="accepted for editors that pass it; it is the default"
    )
