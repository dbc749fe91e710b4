"""The command `handover`: campaigns of simulated handovers, and replays of single tests.

Exit codes: those of `rvmon.cli.campaign`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon import __version__
from rvmon.cli import evidence, guarded
from rvmon.cli.campaign import close_holes, judged_by, mutate_code, names_of, run_tests
from rvmon.cli.campaign_options import (
    add_campaign_options,
    add_closing_options,
    add_judging_options,
    add_mutate_options,
    add_replay_options,
    add_shrink_options,
)
from rvmon.cli.numbers import positive
from rvmon.cli.parser import Parser

if TYPE_CHECKING:
    from rvmon.cdv import Campaign


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: without the program's name; default `sys.argv[1:]`.
    """
    return guarded(lambda: _parser().parse_args(arguments))


def _parser() -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = Parser(
        prog="handover",
        description="Simulated robot-to-human handovers, checked against requirements.",
        epilog="example: handover run --strategy constrained --tests 50 --out out/mine",
    )
    parser.add_argument("--version", action="version", version=f"handover {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_run(commands)
    _add_demo(commands)
    _add_close(commands)
    _add_replay(commands)
    _add_shrink(commands)
    _add_mutate(commands)
    evidence.add_parser(commands, _campaign)
    return parser


def _add_run(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "run",
        help="play a campaign of tests against one robot",
        description="Generate tests, play them on all cores, evaluate them, show and keep the "
        "table.",
        epilog="example: handover run --strategy pseudorandom,constrained --tests 50 --seed 7",
    )
    parser.add_argument(
        "--strategy",
        metavar="NAMES",
        default="pseudorandom,constrained",
        help="of pseudorandom, constrained, model-based, model-based-shortest, "
        "model-based-fastest, disturbed (correct robot only), directed (default: the first two)",
    )
    add_campaign_options(parser)
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    add_judging_options(parser)
    parser.add_argument("--no-monitors", action="store_true", help="evaluate nothing: only play")
    _add_conform(parser, 0)
    parser.set_defaults(run=_run)


def _add_conform(parser: argparse.ArgumentParser, default: int) -> None:
    parser.add_argument(
        "--conform",
        metavar="N",
        type=positive,
        default=default,
        help="with --out, hold the first N runs of each strategy against the model, and check its "
        "claims about all runs (%(default)s)",
    )


def _add_demo(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "demo",
        help="the paper's Table 1, for both robots",
        description="Play tests of every strategy against the robot of the paper's testbench and "
        "against the correct one, and write tables and pages.",
        epilog="example: handover demo --out out/demo",
    )
    add_campaign_options(parser)
    _add_conform(parser, 3)
    parser.set_defaults(run=_demo)


def _add_close(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "close",
        help="make tests until coverage has no holes",
        description="Make tests aimed at what is not covered, by runs of the model, by biased "
        "choices and by changing the nearest test; play and evaluate them until all is covered "
        "that can be; keep the fewest that cover as much.",
        epilog="example: handover close --out out/closed; handover run --suite out/closed/tests",
    )
    parser.add_argument(
        "--strategy",
        metavar="NAMES",
        help="draw from (default: pseudorandom,constrained,disturbed)",
    )
    add_closing_options(parser)
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    parser.set_defaults(run=_close)


def _add_replay(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "replay",
        help="play one test again",
        description="Play a test file alone and evaluate it; the same test gives the same run.",
        epilog="example: handover replay out/demo/tests/pseudorandom-017.json --out out/replay",
    )
    add_replay_options(parser)
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    parser.set_defaults(run=_replay)


def _add_shrink(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "shrink",
        help="find the smallest test that fails like one",
    )
    add_shrink_options(parser)
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    parser.set_defaults(run=_shrink)


def _add_mutate(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "mutate",
        help="which small wrong changes of the robot's code do tests see?",
        description="Change the correct robot's code, one small thing at a time, play suites of "
        "tests on each change, and show what kills it, or which question a survivor asks.",
        epilog="example: handover mutate --strategy directed --out out/mutants",
    )
    add_mutate_options(parser)
    parser.set_defaults(run=_mutate)


def _run(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign

    campaign = handover_campaign(
        (_robot(arguments),), monitors=not arguments.no_monitors, conforming=arguments.conform
    )
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    words: list[object] = ["run", *_legacy(arguments)]
    if arguments.no_monitors:
        words += ["--no-monitors"]
        arguments.spec = None
    words += ["--conform", arguments.conform] if arguments.conform else []
    return run_tests(campaign, strategies, arguments, words)


def _demo(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign
    from rvmon.cdv.pages import REPORT

    campaign = handover_campaign(("legacy", "correct"), conforming=arguments.conform)
    words = ["demo", "--conform", arguments.conform]
    code = run_tests(campaign, tuple(campaign.strategies), arguments, words)
    if arguments.out:
        print(f"Look at {Path(arguments.out) / REPORT}")
    return code


def _close(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign

    robot = _robot(arguments)
    words = ["close", *_legacy(arguments)]
    return close_holes(handover_campaign((robot,)), robot, arguments, words)


def _robot(arguments: argparse.Namespace) -> str:
    return "legacy" if arguments.legacy else "correct"


def _legacy(arguments: argparse.Namespace) -> list[object]:
    """The option that chooses the robot, as words of a command."""
    return ["--legacy"] if arguments.legacy else []


def _replay(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign
    from rvmon.cli.campaign_replay import replay

    campaign = judged_by(handover_campaign(), arguments.spec)
    robot = "legacy" if arguments.legacy else None
    return replay(
        campaign,
        arguments.test,
        robot,
        out=arguments.out,
        mcap=arguments.mcap,
        form=arguments.format,
        expected=arguments.expected,
    )


def _shrink(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign
    from rvmon.cli.campaign_shrink import shrink_file

    robot = "legacy" if arguments.legacy else None
    return shrink_file(
        handover_campaign(), arguments.test, robot, arguments.requirement, arguments.out
    )


def _campaign() -> Campaign:
    from handover.campaign.campaign import handover_campaign

    return handover_campaign()


def _mutate(arguments: argparse.Namespace) -> int:
    from handover.campaign.campaign import handover_campaign

    return mutate_code(handover_campaign(("correct",)), "correct", arguments)


if __name__ == "__main__":
    sys.exit(main())
