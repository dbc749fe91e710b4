"""`rvmon bind`: a binding proposed by what a recording holds."""

from __future__ import annotations

import argparse
import shlex

from rvmon.cli.options import add_const, constants_of
from rvmon.cli.output import busy, say, warn


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "bind",
        description="Print a binding (TOML): which topics and fields of a bag or MCAP file feed "
        "the signals and events of a specification, by what messages mean, by units, types and "
        "words, with the values that they have there. What nothing fits clearly is left open, and "
        "the exit code is then 1. Look it over.",
        epilog="example: rvmon bind base.rv monday.bag > base.toml && "
        "rvmon run base.rv monday.bag --binding base.toml",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument("data", metavar="DATA", help="a bag or MCAP file")
    add_const(parser)


def run(arguments: argparse.Namespace) -> int:
    """Look at the topics, print the binding, and return the exit code."""
    from rvmon.binding.propose import propose
    from rvmon.readers.recording import messages_of
    from rvmon.session import load

    spec = load(arguments.spec, const=constants_of(arguments.const))
    with busy(f"reading {arguments.data}"):
        proposal = propose(spec.checked, messages_of(arguments.data))
    words = shlex.join(["rvmon", "run", arguments.spec, arguments.data, "--binding"])
    say(f"# Proposed: look it over. {words} THIS_FILE")
    say(proposal.text, end="")
    if proposal.unmatched:
        names = ", ".join(f"`{name}`" for name in proposal.unmatched)
        warn(f"warning: what feeds {names} is left open: nothing in {arguments.data} is clearly it")
    for name in proposal.unlabelled:
        warn(
            f"warning: `{name}` is a number in {arguments.data}: say which `labels` stand for which"
        )
    for group in proposal.shared:
        names = " and ".join(f"`{name}`" for name in group)
        warn(f"warning: {names} are fed by one and the same field: is that meant?")
    return int(bool(proposal.unmatched or proposal.unlabelled))
