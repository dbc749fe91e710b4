"""The command `handover`: campaigns of simulated handovers, and replays of single tests.

Exit codes: 0 the campaign completed (a replay: no requirement failed), 1 with `--strict` a
requirement failed, was inconclusive or never triggered (a replay: one failed), 2 wrong input,
3 internal error, 130 interrupted (Ctrl-C, SIGTERM).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from rvmon import __version__
from rvmon.cli import guarded
from rvmon.cli.numbers import positive


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: without the program's name; default `sys.argv[1:]`.
    """
    return guarded(lambda: _parser().parse_args(arguments))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="handover",
        description="Simulated robot-to-human handovers, judged by requirements.",
        epilog="example: handover run --strategy constrained --tests 50 --out out/mine",
    )
    parser.add_argument("--version", action="version", version=f"handover {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_run(commands)
    _add_demo(commands)
    _add_replay(commands)
    return parser


def _add_run(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "run",
        help="play a campaign of tests against one robot",
        description="Generate tests, play them on all cores, judge them, show and keep the table.",
        epilog="example: handover run --strategy pseudorandom,constrained --tests 50 --seed 7",
    )
    parser.add_argument(
        "--strategy",
        metavar="NAMES",
        default="pseudorandom,constrained",
        help="of pseudorandom, constrained, model-based, model-based-shortest, "
        "model-based-fastest, directed (default: the first two)",
    )
    parser.add_argument(
        "--tests", metavar="N", type=positive, default=100, help="of each random strategy (100)"
    )
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    parser.add_argument("--spec", metavar="FILE", help="judge by these requirements")
    parser.add_argument("--no-monitors", action="store_true", help="judge nothing: only play")
    parser.add_argument("--strict", action="store_true", help="exit with 1 unless all is well")
    parser.add_argument(
        "--format",
        choices=("text", "json"),
        default="text",
        help="for people (default), or as data",
    )
    _add_common(parser)
    parser.set_defaults(run=_run, command="run")


def _add_demo(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "demo",
        help="the paper's Table 1, for both robots",
        description="Play tests of every strategy against the robot of the paper's testbench and "
        "against the correct one, and write tables and pages.",
        epilog="example: handover demo --out out/demo",
    )
    parser.add_argument(
        "--tests", metavar="N", type=positive, default=100, help="of each random strategy (100)"
    )
    _add_common(parser)
    parser.set_defaults(run=_demo, command="demo", spec=None, no_monitors=False)


def _add_common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the campaign (1)")
    parser.add_argument("--jobs", metavar="N", type=positive, help="processes (default: all cores)")
    parser.add_argument(
        "--out",
        metavar="DIR",
        help="write tables, tests and pages there; a campaign that was ended there goes on",
    )


def _add_replay(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser(
        "replay",
        help="play one test again",
        description="Play a test file alone and judge it; the same test gives the same run.",
        epilog="example: handover replay out/demo/tests/pseudorandom-017.json --out out/replay",
    )
    parser.add_argument("test", metavar="TEST", help="a .json file")
    parser.add_argument("--legacy", action="store_true", help="the robot of the paper's testbench")
    parser.add_argument("--spec", metavar="FILE", help="judge by these requirements")
    parser.add_argument("--out", metavar="DIR", help="write the recording and a page there")
    parser.add_argument(
        "--format",
        choices=("text", "json"),
        default="text",
        help="for people (default), or as data",
    )
    parser.set_defaults(run=_replay)


def _run(arguments: argparse.Namespace) -> int:
    from handover.campaign.command import run_campaign

    return run_campaign(arguments)


def _demo(arguments: argparse.Namespace) -> int:
    from handover.campaign.command import run_demo

    return run_demo(arguments)


def _replay(arguments: argparse.Namespace) -> int:
    from handover.campaign.replay import run_replay

    return run_replay(arguments)


if __name__ == "__main__":
    sys.exit(main())
