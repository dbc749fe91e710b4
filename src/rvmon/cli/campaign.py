"""The command line of a campaign of tests: `run` plays all, `replay` one, `mutate` mutants of code.

`shrink` makes one smaller, `close` makes its own. Exit codes: 0 all went as expected (a replay: no
requirement failed; `close`: all is covered that can be, too; a test that is shrunk fails), 1 it did
not, 2 wrong input, 3 internal error, 130 interrupted (Ctrl-C, SIGTERM).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cli import evidence, guarded
from rvmon.cli.numbers import duration, number_or_folder, positive, shard
from rvmon.cli.options import add_dask
from rvmon.cli.say import warn
from rvmon.errors import UnknownNameError
from rvmon.report.folder import refuse_no_file, write_file

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
    parser = argparse.ArgumentParser(description=f"{campaign.name}: tests against requirements.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    run = commands.add_parser(
        "run",
        help="play the tests of a campaign",
        description="Generate tests, play and evaluate them on all cores, show and keep the table.",
    )
    run.add_argument(
        "--strategy",
        metavar="NAMES",
        help=f"of {', '.join(campaign.strategies)} (default: all)",
    )
    run.add_argument(
        "--robot", metavar="NAMES", help=f"of {', '.join(campaign.robots)} (default: all)"
    )
    add_campaign_options(run)
    add_judging_options(run)
    run.add_argument(
        "--timeout", metavar="S", type=duration, help="end a test that takes longer (600)"
    )
    run.add_argument("--junit", metavar="FILE", help="write what was expected, and what came out")
    run.add_argument(
        "--strict", action="store_true", help="what is inconclusive or never triggered is a failure"
    )
    run.set_defaults(run=_run)
    close = commands.add_parser(
        "close",
        help="make tests until coverage has no holes",
        description="Make tests aimed at what is not covered, play and evaluate them, until all is "
        "that can be; keep the fewest that cover as much.",
    )
    close.add_argument(
        "--strategy",
        metavar="NAMES",
        help=f"draw from, of {', '.join(campaign.strategies)} (default: those of the campaign)",
    )
    close.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the first)"
    )
    add_closing_options(close)
    close.add_argument(
        "--timeout", metavar="S", type=duration, help="end a test that takes longer (600)"
    )
    close.set_defaults(run=_close)
    replay = commands.add_parser(
        "replay",
        help="play one test again",
        description="Play a test file alone and evaluate it; the same test gives the same run.",
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
    )
    add_mutate_options(mutate)
    mutate.add_argument(
        "--robot", metavar="NAME", help=f"of {', '.join(campaign.robots)} (default: the first)"
    )
    mutate.set_defaults(run=_mutate)
    evidence.add_parser(commands, lambda: campaign)
    return parser


def add_campaign_options(parser: argparse.ArgumentParser) -> None:
    """Declare how many tests are played, and where their results go."""
    parser.add_argument(
        "--tests", metavar="N", type=positive, default=100, help="of each random strategy (100)"
    )
    parser.add_argument(
        "--suite", metavar="DIR", help="play the tests of this folder in the place of strategies'"
    )
    parser.add_argument(
        "--evidence", metavar="FILE", help="keep tests, verdicts and specifications in one archive"
    )
    parser.add_argument(
        "--shard",
        metavar="I/N",
        type=shard,
        help="with --out, play this share, as 2/4; the same without it joins what shards left",
    )
    add_playing_options(parser)


def add_playing_options(parser: argparse.ArgumentParser) -> None:
    """Declare how tests are played, and where their results go."""
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the campaign (1)")
    parser.add_argument("--jobs", metavar="N", type=positive, help="processes (default: all cores)")
    add_dask(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        help="write tables, tests and pages there; a campaign that was ended there goes on",
    )
    parser.add_argument(
        "--pages",
        choices=("examples", "all"),
        default="examples",
        help="of which runs to write a page: an example of each count, or all (%(default)s)",
    )
    parser.add_argument(
        "--shrink",
        action="store_true",
        help="with --out, shrink the tests with a page that fail, and are not made to",
    )


def add_shrink_options(parser: argparse.ArgumentParser) -> None:
    """Declare which test is shrunk, by which failure, and where the smallest one goes."""
    parser.description = (
        "Take away from a failing test what its failure does not need, print what is left, and "
        "write it as a regression test."
    )
    parser.add_argument("test", metavar="TEST", help="a .json file")
    parser.add_argument(
        "--requirement", metavar="ID", help="that is to fail (default: the first that does)"
    )
    parser.add_argument(
        "--out", metavar="DIR", help="write it there, with a test of pytest that replays it"
    )


def add_closing_options(parser: argparse.ArgumentParser) -> None:
    """Declare when closing gives up, and where the suite goes."""
    parser.add_argument(
        "--tests", metavar="N", type=positive, default=400, help="play at most so many (400)"
    )
    parser.add_argument(
        "--seconds", metavar="S", type=duration, help="begin no test after so long (default: any)"
    )
    add_playing_options(parser)
    add_judging_options(parser)


def add_replay_options(parser: argparse.ArgumentParser) -> None:
    """Declare which test is played again, and where its page goes."""
    parser.add_argument("test", metavar="TEST", help="a .json file")
    parser.add_argument("--out", metavar="DIR", help="write the recording and a page there")
    parser.add_argument(
        "--mcap", metavar="FILE", help="write verdicts, values and the scene for Foxglove"
    )
    parser.add_argument(
        "--expected", action="store_true", help="exit with 0 if all came out as the test expects"
    )
    add_judging_options(parser)


def add_mutate_options(parser: argparse.ArgumentParser) -> None:
    """Declare which mutants are played by which tests, and where results go."""
    parser.add_argument(
        "--strategy", metavar="NAMES", help="suites: the tests of each of these (default: all)"
    )
    parser.add_argument(
        "--tests",
        metavar="N|DIR",
        type=number_or_folder,
        default=100,
        help="of each random strategy (100); or a folder of tests, which is the suite",
    )
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the tests (1)")
    parser.add_argument("--jobs", metavar="N", type=positive, help="processes (default: all cores)")
    parser.add_argument(
        "--of",
        choices=("code", "spec", "both"),
        default="both",
        help="mutants of the code, of its requirements, or %(default)s (default)",
    )
    parser.add_argument("--only", metavar="TEXT", default="", help="mutants whose name has this")
    parser.add_argument(
        "--all", action="store_true", help="play all tests, also after a requirement failed"
    )
    parser.add_argument(
        "--held-out", action="store_true", help="show also single mutants that are held out"
    )
    parser.add_argument("--list", action="store_true", help="list the mutants, and play nothing")
    parser.add_argument(
        "--strict", action="store_true", help="exit with 1 unless all mutants are killed"
    )
    parser.add_argument(
        "--out", metavar="DIR", help="write mutation.html, mutation.json and mutation.txt there"
    )
    add_judging_options(parser)


def add_judging_options(parser: argparse.ArgumentParser) -> None:
    """Declare what judges, and in which form verdicts are printed."""
    parser.add_argument("--spec", metavar="FILE", help="check against these requirements")
    parser.add_argument(
        "--format",
        choices=("text", "json"),
        default="text",
        help="for people (default), or as data",
    )


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
    from rvmon.cdv.gate import refuse_unknown
    from rvmon.cdv.junit import junit_xml
    from rvmon.cli.campaign_run import conduct, show

    refuse_unknown(arguments.campaign)
    if arguments.junit is not None:
        refuse_no_file(arguments.junit)
    campaign = judged_by(arguments.campaign, arguments.spec)
    robots = names_of(arguments.robot, tuple(campaign.robots), "robot")
    campaign = replace(campaign, robots={name: campaign.robots[name] for name in robots})
    if arguments.timeout is not None:
        campaign = replace(campaign, timeout_s=arguments.timeout)
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    words: list[object] = ["run"]
    for option in ("strategy", "robot", "spec", "timeout"):
        value = getattr(arguments, option)
        words += [] if value is None else [f"--{option}", value]
    conducted = conduct(campaign, strategies, arguments, words)
    show(campaign, conducted, arguments.format)
    judgement = conducted.judged(strict=arguments.strict)
    cut_short = conducted.summary.cut_short
    if arguments.junit is not None:
        write_file(arguments.junit, junit_xml(campaign.name, judgement, cut_short))
    for what in judgement.wrong:
        warn(f"not as expected: {what}")
    return INTERRUPTED if conducted.interrupted else int(bool(judgement.wrong))


def _close(arguments: argparse.Namespace) -> int:
    from rvmon.cdv.gate import refuse_unknown

    refuse_unknown(arguments.campaign)
    campaign = judged_by(arguments.campaign, arguments.spec)
    robot = one_of(arguments.robot, tuple(campaign.robots), "robot")
    if arguments.timeout is not None:
        campaign = replace(campaign, timeout_s=arguments.timeout)
    words: list[object] = ["close"]
    for option in ("robot", "spec", "timeout"):
        value = getattr(arguments, option)
        words += [] if value is None else [f"--{option}", value]
    return close_holes(campaign, robot, arguments, words)


def close_holes(
    campaign: Campaign, robot: str, arguments: argparse.Namespace, words: Sequence[object]
) -> int:
    """Close the holes of a campaign and return an exit code.

    Args:
        campaign: what it is about.
        robot: of its robots the one that is tested.
        arguments: those of `add_closing_options`, and `strategy`.
        words: the command that does it again, and its options but those and `--strategy`.
    """
    from rvmon.cdv.execute import INTERRUPTED as BY_HAND
    from rvmon.cli.campaign_close import conduct_closing

    strategies: Sequence[str] = ()
    if arguments.strategy is not None:
        strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    closed, wrong = conduct_closing(campaign, robot, strategies, arguments, words)
    for what in wrong:
        warn(f"not as expected: {what}")
    if closed.ended == BY_HAND:
        return INTERRUPTED
    return int(bool(closed.open or closed.wrong or wrong))


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
