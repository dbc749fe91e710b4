"""The command line of a campaign of tests: `run` plays all, `replay` one, `mutate` mutants of code.

`shrink` makes one smaller, `close` makes its own. Exit codes: 0 all went as expected (a replay: no
requirement failed; `close`: all is covered that can be, too; a test that is shrunk fails), 1 it did
not, 2 wrong input, 3 internal error, 130 interrupted (Ctrl-C, SIGTERM).
"""

from __future__ import annotations

import argparse
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.gate import CampaignJudgement, junit_xml
from rvmon.cli import evidence, guarded
from rvmon.cli.campaign_options import (
    add_campaign_options,
    add_closing_options,
    add_judging_options,
    add_mutate_options,
    add_replay_options,
    add_shrink_options,
)
from rvmon.cli.output import warn
from rvmon.cli.parser import Parser
from rvmon.errors import UnknownNameError
from rvmon.report.folder import refuse_no_file, write_file
from rvmon.report.percent import counted

SHOWN = 20
"""Lines about what is wrong; `--junit` has all of them."""


def held(campaign: Campaign, judgement: CampaignJudgement, arguments: Namespace) -> bool:
    """Print, and write as JUnit XML, what a campaign came to; return whether all is as expected.

    Args:
        campaign: what it was about.
        judgement: on its tests.
        arguments: with `junit`, the path of a file or `None`.
    """
    if arguments.junit is not None:
        write_file(arguments.junit, junit_xml(campaign.name, judgement))
    for what, count in judgement.known.items():
        warn(f"{what} ({counted(count, 'test')})")
    wrong = judgement.wrong
    for what in wrong[:SHOWN]:
        warn(f"not as expected: {what}")
    if len(wrong) > SHOWN:
        warn(f"not as expected: … and {len(wrong) - SHOWN:,} more: --junit FILE has all")
    return not wrong


INTERRUPTED = 130
"""The exit code of a campaign that was interrupted."""


def main(campaign: Campaign, arguments: Sequence[str] | None = None) -> int:
    """Run the command line of a campaign and return its exit code.

    Args:
        campaign: what it is about.
        arguments: without the program's name; default `sys.argv[1:]`.
    """

    def parsed() -> argparse.Namespace:
        found = _parser(campaign).parse_args(arguments)
        found.campaign = campaign
        return found

    return guarded(parsed)


def _parser(campaign: Campaign) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = Parser(description=f"{campaign.name}: evaluated tests.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    run = commands.add_parser(
        "run",
        help="play the tests of a campaign",
        description="Generate tests, play them on all cores, evaluate them, keep the table.",
        epilog="example: %(prog)s --tests 20 --out out/mine",
    )
    strategies = ", ".join(campaign.strategies)
    run.add_argument("--strategy", metavar="NAMES", help=f"of {strategies} (default: all)")
    run.add_argument(
        "--robot", metavar="NAMES", help=f"of {', '.join(campaign.robots)} (default: all)"
    )
    add_campaign_options(run)
    add_judging_options(run)
    run.set_defaults(run=_run)
    close = commands.add_parser(
        "close",
        help="make tests until coverage has no holes",
        description="Make tests aimed at what is not covered, play and evaluate them, until all is "
        "that can be; keep the fewest that cover as much.",
        epilog="example: %(prog)s --out out/closed",
    )
    close.add_argument(
        "--strategy", metavar="NAMES", help=f"of {strategies} (default: those of the campaign)"
    )
    close.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the first)"
    )
    add_closing_options(close)
    close.set_defaults(run=_close)
    replay = commands.add_parser(
        "replay",
        help="play one test again",
        description="Play a test file alone and evaluate it; the same test gives the same run.",
        epilog="example: %(prog)s out/mine/tests/pseudorandom-001.json --out out/replay",
    )
    add_replay_options(replay)
    replay.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the test's)"
    )
    replay.set_defaults(run=_replay)
    smaller = commands.add_parser("shrink", help="find the smallest test that fails like one")
    add_shrink_options(smaller)
    smaller.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the test's)"
    )
    smaller.set_defaults(run=_shrink)
    mutate = commands.add_parser(
        "mutate",
        help="which small wrong changes of the code, and of requirements, do tests see?",
        description="Change one small thing at a time, play the tests of each strategy, and show "
        "what kills the mutant, or which question a survivor asks.",
        epilog="example: %(prog)s --list",
    )
    add_mutate_options(mutate)
    mutate.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the first)"
    )
    mutate.set_defaults(run=_mutate)
    evidence.add_parser(commands, lambda: campaign)
    return parser


def names_of(listed: str | None, known: Sequence[str], what: str) -> tuple[str, ...]:
    """Read names that are separated by commas.

    Args:
        listed: on the command line; `None`: all.
        known: that there are.
        what: the word for one, also of its option.

    Raises:
        UnknownNameError: one does not exist, or none is named.
    """
    if listed is None:
        return tuple(known)
    names = tuple(dict.fromkeys(name.strip() for name in listed.split(",") if name.strip()))
    if not names:
        raise UnknownNameError(f"--{what} names none: there are {', '.join(known)}")
    return tuple(one_of(name, known, what) for name in names)


def one_of(named: str | None, known: Sequence[str], what: str) -> str:
    """Read one name; `None`: the first that there is.

    Raises:
        UnknownNameError: it does not exist.
    """
    if named is not None and named not in known:
        raise UnknownNameError(f"no {what} `{named}`: there are {', '.join(known)}")
    return known[0] if named is None else named


def judged_by(campaign: Campaign, spec: str | None) -> Campaign:
    """The campaign with other requirements for all of its robots; `None`: as it is."""
    if spec is None:
        return campaign
    robots = {
        name: replace(robot, spec=Path(spec), spec_name="")
        for name, robot in campaign.robots.items()
    }
    return replace(campaign, robots=robots)


def _run(arguments: argparse.Namespace) -> int:
    campaign = arguments.campaign
    robots = names_of(arguments.robot, tuple(campaign.robots), "robot")
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    return run_tests(
        campaign, strategies, arguments, ["run", *_given(arguments, "robot")], robots=robots
    )


def run_tests(
    campaign: Campaign,
    strategies: Sequence[str],
    arguments: argparse.Namespace,
    words: Sequence[object],
    *,
    robots: Sequence[str] = (),
) -> int:
    """Play a campaign, show it, hold it against what was expected, and return an exit code.

    Args:
        campaign: what it is about.
        strategies: that make tests.
        arguments: those of `add_campaign_options`; perhaps `strategy`, `spec` and `format`.
        words: the command that runs it again, and its options but those.
        robots: of its robots those that are tested; default: all.
    """
    from rvmon.cli.campaign_run import conduct, show

    campaign = _as_asked(campaign, arguments)
    tested = robots or campaign.robots
    campaign = replace(campaign, robots={name: campaign.robots[name] for name in tested})
    words = [*words, *_given(arguments, "strategy", "spec", "timeout")]
    conducted = conduct(campaign, strategies, arguments, words)
    show(campaign, conducted, getattr(arguments, "format", "text"))
    is_fine = held(campaign, conducted.judged(strict=arguments.strict), arguments)
    return INTERRUPTED if conducted.interrupted else int(not is_fine)


def _as_asked(campaign: Campaign, arguments: argparse.Namespace) -> Campaign:
    """The campaign as the options change it; wrong ones are refused before anything is played."""
    from rvmon.cdv.gate import refuse_unknown

    refuse_unknown(campaign)
    if arguments.junit is not None:
        refuse_no_file(arguments.junit)
    if arguments.timeout is not None:
        campaign = replace(campaign, timeout_s=arguments.timeout)
    return judged_by(campaign, getattr(arguments, "spec", None))


def _given(arguments: argparse.Namespace, *options: str) -> list[object]:
    """Those options that were given, as words of a command."""
    values = ((option, getattr(arguments, option, None)) for option in options)
    return [word for name, value in values if value is not None for word in (f"--{name}", value)]


def _close(arguments: argparse.Namespace) -> int:
    robot = one_of(arguments.robot, tuple(arguments.campaign.robots), "robot")
    return close_holes(arguments.campaign, robot, arguments, ["close", *_given(arguments, "robot")])


def close_holes(
    campaign: Campaign, robot: str, arguments: argparse.Namespace, words: Sequence[object]
) -> int:
    """Close the holes of a campaign and return an exit code.

    Args:
        campaign: what it is about.
        robot: of its robots the one that is tested.
        arguments: those of `add_closing_options`, and `strategy`.
        words: the command that does it again, and its options but those.
    """
    from rvmon.cdv.play import INTERRUPTED as BY_HAND
    from rvmon.cli.campaign_close import conduct_closing

    campaign = _as_asked(campaign, arguments)
    words = [*words, *_given(arguments, "spec", "timeout")]

    strategies: Sequence[str] = ()
    if arguments.strategy is not None:
        strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    closed, judgement = conduct_closing(campaign, robot, strategies, arguments, words)
    is_fine = held(campaign, judgement, arguments)
    if closed.ended == BY_HAND:
        return INTERRUPTED
    return int(bool(closed.open or closed.wrong) or not is_fine)


def _replay(arguments: argparse.Namespace) -> int:
    from rvmon.cli.campaign_replay import replay as play_again

    campaign = judged_by(arguments.campaign, arguments.spec)
    return play_again(
        campaign,
        arguments.test,
        arguments.robot,
        out=arguments.out,
        mcap=arguments.mcap,
        form=arguments.format,
        expected=arguments.expected,
    )


def _shrink(arguments: argparse.Namespace) -> int:
    from rvmon.cli.campaign_shrink import shrink_file

    return shrink_file(
        arguments.campaign,
        arguments.test,
        arguments.robot,
        arguments.requirement,
        arguments.out,
    )


def mutate_code(campaign: Campaign, robot: str, arguments: argparse.Namespace) -> int:
    """Play suites on mutants, as the options of `add_mutate_options` say; return an exit code."""
    from rvmon.cli.campaign_mutate import mutate

    campaign = judged_by(campaign, arguments.spec)
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    return mutate(campaign, robot, strategies, arguments)


def _mutate(arguments: argparse.Namespace) -> int:
    robots = tuple(arguments.campaign.robots)
    robot = names_of(arguments.robot, robots, "robot")[0]
    return mutate_code(arguments.campaign, robot, arguments)
