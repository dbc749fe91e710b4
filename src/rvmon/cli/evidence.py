"""`rvmon evidence`: does evidence that was kept still hold?"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from rvmon.cli.numbers import positive

if TYPE_CHECKING:
    from rvmon.cdv.campaign import Campaign


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
    campaign: Callable[[], Campaign] | None = None,
) -> None:
    """Declare the subcommand's arguments.

    Args:
        subparsers: take it.
        campaign: makes the campaign whose tests are played again; `None`: they are not.
    """
    parser = subparsers.add_parser("evidence", help="see whether evidence that was kept holds")
    verify = parser.add_subparsers(metavar="COMMAND", required=True).add_parser(
        "verify",
        help="see whether it holds",
        description="See that nothing in evidence (`--evidence FILE`) was changed, that recordings "
        "are those that were evaluated, and evaluate a sample again. Exit codes: 0 it holds, 1 it "
        "does not, 2 something could not be checked.",
        epilog="example: %(prog)s base.zip --sample all",
    )
    verify.add_argument("file", metavar="FILE", help="the evidence")
    verify.add_argument(
        "--sample",
        metavar="N",
        type=lambda text: None if text == "all" else positive(text),
        default=10,
        help="evaluate so many recordings or tests again, or all (%(default)s)",
    )
    verify.add_argument("--seed", metavar="S", type=int, default=1, help="of the sample (1)")
    verify.add_argument("--jobs", metavar="N", type=positive, default=1, help="processes (1)")
    verify.set_defaults(run=run, made=campaign)


def run(arguments: argparse.Namespace) -> int:
    """Verify, say what was found, and return the exit code."""
    from rvmon.cli.evidence_verify import verify

    return verify(arguments)
