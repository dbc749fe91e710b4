"""The command line of a campaign of tests.

`run` plays all tests, `replay` plays one, `mutate` plays tests on mutants of the code, `shrink`
makes a failing test smaller, and `close` generates tests until coverage has no holes.

Exit codes: 0 all is as expected (`replay`: no requirement failed; `close`: also, all that can be
covered is; `shrink`: the test fails), 1 it is not, 2 wrong input, 3 internal error, 130 interrupted
(Ctrl-C, SIGTERM).
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from rvmon.cdv.campaign import Campaign
from rvmon.cli import evidence, guarded
from rvmon.cli.evaluate_commands import add_evidence
from rvmon.cli.options import declare, names_in
from rvmon.cli.parser import (
    TIME_FORMS,
    Parser,
    Subparsers,
    number_or_folder,
    positive,
    shard,
    span_s,
)
from rvmon.errors import UnknownNameError
from rvmon.files import refuse_no_file

INTERRUPTED = 130  # the exit code of a campaign that was interrupted


def main(campaign: Campaign, arguments: Sequence[str] | None = None) -> int:
    """Run the command line of a campaign, default `sys.argv[1:]`, and return its exit code."""

    def parsed() -> Namespace:
        parser = Parser(description=f"{campaign.name}: generate, play and evaluate tests.")
        commands = parser.add_subparsers(metavar="COMMAND", required=True)
        robots, strategies = ", ".join(campaign.robots), ", ".join(campaign.strategies)
        add_commands(commands, lambda _: campaign, robots=robots, strategies=strategies)
        return parser.parse_args(arguments)

    return guarded(parsed)


def add_commands(
    commands: Subparsers,
    campaign: Callable[[Namespace], Campaign],
    *,
    robots: str,
    strategies: str,
    defaults: Mapping[str, Mapping[str, str]] | None = None,
) -> dict[str, Parser]:
    """Declare the commands of a campaign; a program may add its own options to their parsers.

    Args:
        commands: receives the parsers of the commands.
        campaign: creates the campaign from the parsed command line.
        robots: the names of its robots, for help texts.
        strategies: the names of its strategies, for help texts.
        defaults: by command, the default `robot` and `strategy`.

    Returns:
        The parsers by command. A program can set their default `again` to the names of further
        options that belong to a command line which repeats the run.
    """
    parsers = {}
    for name, command in _COMMANDS.items():
        parser = commands.add_parser(
            name,
            help=command.help,
            description=command.description,
            epilog=f"example: %(prog)s {command.example}",
        )
        parser.set_defaults(run=command.run, campaign=campaign, command=name, again=())
        preset = (defaults or {}).get(name, {})
        about = f"of {robots} (default: {preset.get('robot', command.robot)})"
        value = "NAMES" if name == "run" else "NAME"
        parser.option(f"--robot {value}", about, default=preset.get("robot"))
        if name in ("replay", "shrink"):
            parser.option("TEST", "a test, a .json file")
        else:
            drawn = preset.get("strategy", "those of the campaign" if name == "close" else "all")
            about = f"of {strategies} (default: {drawn})"
            parser.option("--strategy NAMES", about, default=preset.get("strategy"))
        command.add_options(parser)
        if name != "shrink":
            parser.option("--spec FILE", "evaluate these requirements")
            declare(parser, "--format")
        parsers[name] = parser
    add_evidence(commands)
    commands.choices["evidence"].set_defaults(run=evidence.run_evidence, campaign=campaign)
    return parsers


def _run(arguments: Namespace) -> int:
    return run_tests(_checked_campaign(arguments), arguments)


def run_tests(campaign: Campaign, arguments: Namespace) -> int:
    """Play a campaign, print it, compare it with the expected verdicts, and return an exit code.

    `arguments` has the options of `add_run_options`, and optionally `strategy`, `robot`, `spec` and
    `format`.
    """
    from rvmon.cli.campaign_run import conduct, is_as_expected, show

    given = vars(arguments)
    robots = names_of(given.get("robot"), tuple(campaign.robots), "robot")
    strategies = names_of(given.get("strategy"), tuple(campaign.strategies), "strategy")
    campaign = replace(campaign, robots={name: campaign.robots[name] for name in robots})
    with ExitStack() as stack:
        words = _words(arguments, "strategy")
        conducted = conduct(campaign, strategies, arguments, words, stack)
    show(campaign, conducted, given.get("format", "text"))
    is_fine = is_as_expected(campaign, conducted.judged(strict=arguments.strict), arguments)
    return INTERRUPTED if conducted.interrupted else int(not is_fine)


def _close(arguments: Namespace) -> int:
    from rvmon.cdv.play import INTERRUPTED as BY_HAND
    from rvmon.cli.campaign_close import conduct_closing
    from rvmon.cli.campaign_run import is_as_expected

    campaign = _checked_campaign(arguments)
    robot = _one_robot(campaign, arguments)
    strategies: Sequence[str] = ()
    if arguments.strategy is not None:
        strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    words = _words(arguments)
    closed, judgement = conduct_closing(campaign, robot, strategies, arguments, words)
    is_fine = is_as_expected(campaign, judgement, arguments)
    if closed.ended == BY_HAND:
        return INTERRUPTED
    return int(bool(closed.open or closed.wrong) or not is_fine)


def _one_test(arguments: Namespace) -> int:
    from rvmon.cli.campaign_run import replay, shrink_file

    work = replay if arguments.command == "replay" else shrink_file
    return work(_with_timeout_and_spec(arguments), arguments)


def _mutate(arguments: Namespace) -> int:
    from rvmon.cli.campaign_mutate import mutate

    campaign = _with_timeout_and_spec(arguments)
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    return mutate(campaign, _one_robot(campaign, arguments), strategies, arguments)


def names_of(listed: str | None, known: Sequence[str], what: str) -> tuple[str, ...]:
    """Parse names separated by commas; `None`: all.

    Raises:
        UnknownNameError: a name does not exist, or there is none.
    """
    if listed is None:
        return tuple(known)
    names = tuple(dict.fromkeys(names_in(listed)))
    if not names:
        raise UnknownNameError(f"--{what} is empty: there are {', '.join(known)}")
    for name in names:
        if name not in known:
            raise UnknownNameError(f"no {what} `{name}`: there are {', '.join(known)}")
    return names


def _one_robot(campaign: Campaign, arguments: Namespace) -> str:
    return names_of(arguments.robot, tuple(campaign.robots), "robot")[0]


def _with_timeout_and_spec(arguments: Namespace) -> Campaign:
    """The campaign with the options `--timeout` and `--spec` applied."""
    campaign: Campaign = arguments.campaign(arguments)
    if getattr(arguments, "timeout", None) is not None:
        campaign = replace(campaign, timeout_s=arguments.timeout)
    spec = getattr(arguments, "spec", None)
    if spec is None:
        return campaign
    robots = {
        name: replace(robot, spec=Path(spec), spec_name="")
        for name, robot in campaign.robots.items()
    }
    return replace(campaign, robots=robots)


def _checked_campaign(arguments: Namespace) -> Campaign:
    """The campaign with the options applied; wrong ones are refused before any test is played."""
    from rvmon.cdv.gate import refuse_unknown

    refuse_unknown(arguments.campaign(arguments))
    if arguments.junit is not None:
        refuse_no_file(arguments.junit)
    return _with_timeout_and_spec(arguments)


def _words(arguments: Namespace, *options: str) -> list[object]:
    """The command line that repeats this one, as words, with the options that were given."""
    words: list[object] = [arguments.command]
    for option in ("robot", *arguments.again, *options, "spec", "timeout"):
        value = getattr(arguments, option, None)
        if value:
            words += [f"--{option.replace('_', '-')}", *([] if value is True else [value])]
    return words


def add_run_options(parser: Parser) -> None:
    """Declare the options of `run`: which tests are played, and where results go."""
    parser.option(
        "--tests N", "number of tests of each random strategy (100)", type=positive, default=100
    )
    parser.option("--suite DIR", "play the tests of this folder instead of generated ones")
    parser.option("--evidence FILE", "keep tests, verdicts and specifications in one archive")
    parser.option(
        "--shard I/N",
        "with --out: play one share of the tests, such as 2/4; the same command without --shard "
        "joins the shares",
        type=shard,
    )
    parser.option(
        "--strict",
        "exit with 1 also if a requirement is inconclusive, if one was never triggered by a "
        "strategy that must trigger it, or if coverage is too low",
    )
    _add_playing_options(parser)


def _add_playing_options(parser: Parser) -> None:
    _add_seed_and_jobs(parser)
    declare(parser, "--dask")
    _add_timeout(parser)
    parser.option("--junit FILE", "write expected and actual verdicts as JUnit XML")
    parser.option(
        "--out DIR",
        "write tables, tests and pages into this folder; an interrupted campaign is continued",
    )
    parser.option(
        "--pages",
        "runs to write pages of: an example of each verdict, or all (%(default)s)",
        choices=("examples", "all"),
        default="examples",
    )


def _add_closing_options(parser: Parser) -> None:
    """Declare the options of `close`: when it gives up, and where the suite goes."""
    parser.option("--tests N", "play at most N tests (400)", type=positive, default=400)
    parser.option(
        "--seconds TIME", f"start no test after TIME ({TIME_FORMS}; default: no limit)", type=span_s
    )
    parser.option(
        "--margin N",
        "keep up to N tests for each goal (2): one covers it, more detect more faults",
        type=positive,
        default=2,
    )
    parser.option(
        "--mutants N",
        "also keep a smallest set of tests that kills further mutants, out of N mutants of the "
        "code; show how many of these mutants, and of the held-out ones, each selection of tests "
        "kills",
        type=positive,
    )
    _add_playing_options(parser)


def _add_replay_options(parser: Parser) -> None:
    """Declare the options of `replay`: where the run of the test goes."""
    parser.option("--out DIR", "write the recording and a page into this folder")
    parser.option("--mcap FILE", "write verdicts, values and the scene for Foxglove")
    parser.option("--expected", "exit with 0 if all verdicts are as the test expects")


def _add_shrink_options(parser: Parser) -> None:
    """Declare the options of `shrink`: which failure has to stay, and where the test goes."""
    parser.option(
        "--requirement ID", "the requirement that has to fail (default: the first that fails)"
    )
    _add_timeout(parser)
    parser.option("--out DIR", "write it into this folder, with a pytest test that replays it")


def _add_mutate_options(parser: Parser) -> None:
    """Declare the options of `mutate`: which tests, which mutants, and where results go."""
    parser.option(
        "--tests N|DIR",
        "number of tests of each random strategy (100), or a folder of tests",
        type=number_or_folder,
        default=100,
    )
    _add_seed_and_jobs(parser)
    _add_timeout(parser)
    parser.option(
        "--of",
        "mutate the code, its requirements, or %(default)s (default)",
        choices=("code", "spec", "both"),
        default="both",
    )
    parser.option("--only TEXT", "only mutants whose name contains TEXT", default="")
    parser.option("--all", "play all tests, even after a requirement has failed")
    parser.option("--held-out", "also list the held-out mutants one by one")
    parser.option("--list", "list the mutants without playing tests")
    parser.option("--strict", "exit with 1 unless all mutants are killed")
    parser.option(
        "--out DIR", "write mutation.html, mutation.json and mutation.txt into this folder"
    )


def _add_seed_and_jobs(parser: Parser) -> None:
    parser.option("--seed N", "random seed of everything (1)", type=int, default=1)
    parser.option("--jobs N", "number of processes (default: all cores)", type=positive)


def _add_timeout(parser: Parser) -> None:
    parser.option(
        "--timeout TIME", f"end a test that takes longer ({TIME_FORMS}; default: 600)", type=span_s
    )


class _Command(NamedTuple):
    add_options: Callable[[Parser], None]
    run: Callable[[Namespace], int]
    robot: str  # the default robot, in words
    help: str
    description: str
    example: str


_FAILING = "out/mine/tests/pseudorandom-001.json"

_COMMANDS = {
    "run": _Command(
        *(add_run_options, _run, "all"),
        "play the tests of a campaign",
        "Generate tests, play them on all cores, evaluate them, and write the table of verdicts.",
        "--tests 20 --out out/mine",
    ),
    "close": _Command(
        *(_add_closing_options, _close, "the first"),
        "generate tests until coverage has no holes",
        "Generate tests for uncovered items: from runs of a model if there is one, by biased "
        "choices, and by mutating the nearest test. Play and evaluate them until everything that "
        "can be covered is covered; keep a smallest set of tests with the same coverage.",
        "--out out/closed",
    ),
    "replay": _Command(
        *(_add_replay_options, _one_test, "the test's"),
        "play one test again",
        "Play a test file alone and evaluate it; the same test gives the same run.",
        f"{_FAILING} --out out/replay",
    ),
    "shrink": _Command(
        *(_add_shrink_options, _one_test, "the test's"),
        "reduce a failing test to the smallest one that still fails",
        "Remove from a failing test everything that its failure does not need, print the rest, and "
        "write it as a regression test.",
        f"{_FAILING} --out out/small",
    ),
    "mutate": _Command(
        *(_add_mutate_options, _mutate, "the first"),
        "measure which small faults in code and requirements the tests detect",
        "Plant one small fault at a time, play the tests of each strategy, and show which test "
        "kills each mutant, and which question each survivor raises.",
        "--list",
    ),
}
