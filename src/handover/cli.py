"""The command `handover`: campaigns of simulated handovers, and replays of single tests.

Its exit codes are those of `rvmon.cli.campaign`.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon import __version__
from rvmon.cli import guarded
from rvmon.cli.campaign import add_commands, add_run_options, run_tests
from rvmon.cli.parser import Parser, positive

if TYPE_CHECKING:
    from rvmon.cdv import Campaign

ROBOTS = ("correct", "legacy")
STRATEGIES = (
    "pseudorandom, constrained, model-based, model-based-shortest, model-based-fastest, disturbed "
    "(correct robot only), directed"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: without the program's name; default: `sys.argv[1:]`.
    """
    return guarded(lambda: _parser().parse_args(arguments))


def _parser() -> Parser:
    parser = Parser(
        prog="handover",
        description="Simulated robot-to-human handovers, checked against requirements.",
        epilog="example: handover run --strategy constrained --tests 50 --out out/mine",
    )
    parser.add_argument("--version", action="version", version=f"handover {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    demo = commands.add_parser(
        "demo",
        help="the paper's Table 1, for both robots",
        description="Play tests of every strategy against the robot of the paper's testbench and "
        "against the correct one, and write tables and pages.",
        epilog="example: handover demo --out out/demo",
    )
    add_run_options(demo)
    demo.set_defaults(run=_demo, command="demo", again=("conform",))
    own = add_commands(
        commands,
        _campaign,
        robots=" and ".join(ROBOTS),
        strategies=STRATEGIES,
        defaults={
            "run": {"robot": "correct", "strategy": "pseudorandom,constrained"},
            "close": {"robot": "correct"},
            "mutate": {"robot": "correct"},
        },
    )
    for name in ("run", "close", "replay", "shrink"):
        own[name].add_argument(
            "--legacy",
            action="store_const",
            dest="robot",
            const="legacy",
            help="as --robot legacy: the robot of the paper's testbench",
        )
    own["run"].option("--no-monitors", "evaluate nothing: only play")
    own["run"].set_defaults(again=("no_monitors", "conform"))
    for argument_parser, count in ((demo, 3), (own["run"], 0)):
        argument_parser.option(
            "--conform N",
            "with --out, compare the first N runs of each strategy with the model, and check its "
            "claims about all runs (%(default)s)",
            type=positive,
            default=count,
        )
    return parser


def _campaign(arguments: Namespace) -> Campaign:
    from handover.campaign.campaign import handover_campaign

    given = vars(arguments)
    requested = (given.get("robot") or "").split(",")
    return handover_campaign(
        [name for name in ROBOTS if name in requested] or ROBOTS,
        monitors=not given.get("no_monitors"),
        conforming=given.get("conform", 0),
    )


def _demo(arguments: Namespace) -> int:
    from handover.campaign.campaign import handover_campaign
    from rvmon.cdv.replay_pages import REPORT

    campaign = handover_campaign(("legacy", "correct"), conforming=arguments.conform)
    code = run_tests(campaign, arguments)
    if arguments.out:
        print(f"Look at {Path(arguments.out) / REPORT}")
    return code


if __name__ == "__main__":
    sys.exit(main())
