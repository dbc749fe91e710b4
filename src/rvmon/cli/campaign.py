"""The command line of a campaign of tests: `run` plays all, `replay` one, `mutate` mutants of code.

`shrink` makes one smaller, `close` makes its own. Exit codes: 0 all went as expected (a replay: no
requirement failed; `close`: all is covered that can be, too; a test that is shrunk fails), 1 it did
not, 2 wrong input, 3 internal error, 130 interrupted (Ctrl-C, SIGTERM).
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace, _SubParsersAction
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.gate import CampaignJudgement, junit_xml
from rvmon.cli import evidence, guarded
from rvmon.cli.campaign_options import (
    add_closing_options,
    add_judging_options,
    add_mutate_options,
    add_replay_options,
    add_run_options,
    add_shrink_options,
)
from rvmon.cli.evaluate_commands import add_evidence
from rvmon.cli.output import warn
from rvmon.cli.parser import Parser
from rvmon.errors import UnknownNameError
from rvmon.files import refuse_no_file, write_file
from rvmon.texts import counted

SHOWN = 20
"""Lines about what is wrong; `--junit` has all of them."""

INTERRUPTED = 130
"""The exit code of a campaign that was interrupted."""


def main(campaign: Campaign, arguments: Sequence[str] | None = None) -> int:
    """Run the command line of a campaign and return its exit code.

    Args:
        campaign: the campaign.
        arguments: without the program's name; default `sys.argv[1:]`.
    """

    def parsed() -> Namespace:
        parser: ArgumentParser = Parser(
            description=f"{campaign.name}: generate, play and evaluate tests."
        )
        commands = parser.add_subparsers(metavar="COMMAND", required=True)
        robots, strategies = ", ".join(campaign.robots), ", ".join(campaign.strategies)
        add_commands(commands, lambda _: campaign, robots=robots, strategies=strategies)
        return parser.parse_args(arguments)

    return guarded(parsed)


def add_commands(
    commands: _SubParsersAction[ArgumentParser],
    campaign: Callable[[Namespace], Campaign],
    *,
    robots: str,
    strategies: str,
    defaults: Mapping[str, Mapping[str, str]] | None = None,
) -> dict[str, ArgumentParser]:
    """Declare the commands of a campaign; a program may add options of its own to their parsers.

    Args:
        commands: take them.
        campaign: makes the campaign once the command line is read.
        robots: the names of its robots, for people.
        strategies: of the campaign, to choose from.
        defaults: by command, the `robot` and the `strategy` that it takes if none is named.

    Returns:
        The parsers by command. `again`, if a program sets it, names further options that belong to
        the command which does the same again.
    """
    parsers = {
        "run": commands.add_parser(
            "run",
            help="play the tests of a campaign",
            description="Generate tests, play them on all cores, evaluate them, and write the "
            "table of verdicts.",
            epilog="example: %(prog)s --tests 20 --out out/mine",
        ),
        "close": commands.add_parser(
            "close",
            help="generate tests until coverage has no holes",
            description="Generate tests aimed at uncovered items: from runs of a model if there "
            "is one, by biased choices, and by mutating the nearest test. Play and evaluate them "
            "until everything that can be covered is; keep a smallest set of tests with the same "
            "coverage.",
            epilog="example: %(prog)s --out out/closed",
        ),
        "replay": commands.add_parser(
            "replay",
            help="play one test again",
            description="Play a test file alone and evaluate it; the same test gives the same run.",
            epilog="example: %(prog)s out/mine/tests/pseudorandom-001.json --out out/replay",
        ),
        "shrink": commands.add_parser(
            "shrink",
            help="reduce a failing test to the smallest one that still fails",
            description="Remove from a failing test everything that its failure does not need, "
            "print the rest, and write it as a regression test.",
            epilog="example: %(prog)s out/mine/tests/pseudorandom-001.json --out out/small",
        ),
        "mutate": commands.add_parser(
            "mutate",
            help="measure which small faults in code and requirements the tests detect",
            description="Plant one small fault at a time, play the tests of each strategy, and "
            "show which test kills the mutant, or the question that a survivor raises.",
            epilog="example: %(prog)s --list",
        ),
    }
    handlers = (_run, _close, _replay, _shrink, _mutate)
    first = ("all", "the first", "the test's", "the test's", "the first")
    for (name, parser), handler, robot in zip(parsers.items(), handlers, first, strict=True):
        parser.set_defaults(run=handler, campaign=campaign, command=name, again=())
        preset = (defaults or {}).get(name, {})
        metavar = "NAMES" if name == "run" else "NAME"
        about = f"of {robots} (default: {preset.get('robot', robot)})"
        parser.add_argument("--robot", metavar=metavar, default=preset.get("robot"), help=about)
        if name not in ("replay", "shrink"):
            drawn = preset.get("strategy", "those of the campaign" if name == "close" else "all")
            about = f"of {strategies} (default: {drawn})"
            parser.add_argument(
                "--strategy", metavar="NAMES", default=preset.get("strategy"), help=about
            )
    add_run_options(parsers["run"])
    add_closing_options(parsers["close"])
    for name in ("replay", "shrink"):
        parsers[name].add_argument("test", metavar="TEST", help="a test, a .json file")
    add_replay_options(parsers["replay"])
    add_shrink_options(parsers["shrink"])
    add_mutate_options(parsers["mutate"])
    for name in ("run", "close", "replay", "mutate"):
        add_judging_options(parsers[name])
    add_evidence(commands)
    commands.choices["evidence"].set_defaults(run=evidence.run, campaign=campaign)
    return parsers


def _run(arguments: Namespace) -> int:
    return run_tests(_as_asked(arguments), arguments)


def run_tests(campaign: Campaign, arguments: Namespace) -> int:
    """Play a campaign, show it, compare it with what was expected, and return an exit code.

    Args:
        campaign: the campaign.
        arguments: the options of `add_run_options`; perhaps `strategy`, `robot`, `spec` and
            `format`.
    """
    from rvmon.cli.campaign_run import conduct, show

    given = vars(arguments)
    robots = names_of(given.get("robot"), tuple(campaign.robots), "robot")
    strategies = names_of(given.get("strategy"), tuple(campaign.strategies), "strategy")
    campaign = replace(campaign, robots={name: campaign.robots[name] for name in robots})
    with ExitStack() as stack:
        words = _words(arguments, "strategy")
        conducted = conduct(campaign, strategies, arguments, words, stack)
    show(campaign, conducted, given.get("format", "text"))
    is_fine = _held(campaign, conducted.judged(strict=arguments.strict), arguments)
    return INTERRUPTED if conducted.interrupted else int(not is_fine)


def _close(arguments: Namespace) -> int:
    from rvmon.cdv.play import INTERRUPTED as BY_HAND
    from rvmon.cli.campaign_close import conduct_closing

    campaign = _as_asked(arguments)
    robot = _one_robot(campaign, arguments)
    strategies: Sequence[str] = ()
    if arguments.strategy is not None:
        strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    words = _words(arguments)
    closed, judgement = conduct_closing(campaign, robot, strategies, arguments, words)
    is_fine = _held(campaign, judgement, arguments)
    if closed.ended == BY_HAND:
        return INTERRUPTED
    return int(bool(closed.open or closed.wrong) or not is_fine)


def _replay(arguments: Namespace) -> int:
    from rvmon.cli.campaign_run import replay

    return replay(_judged_by(arguments), arguments)


def _shrink(arguments: Namespace) -> int:
    from rvmon.cli.campaign_run import shrink_file

    return shrink_file(_judged_by(arguments), arguments)


def _mutate(arguments: Namespace) -> int:
    from rvmon.cli.campaign_mutate import mutate

    campaign = _judged_by(arguments)
    strategies = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    return mutate(campaign, _one_robot(campaign, arguments), strategies, arguments)


def names_of(listed: str | None, known: Sequence[str], what: str) -> tuple[str, ...]:
    """Read names that are separated by commas.

    Args:
        listed: on the command line; `None`: all.
        known: the existing ones.
        what: the word for one, also of its option.

    Raises:
        UnknownNameError: one does not exist, or none is named.
    """
    if listed is None:
        return tuple(known)
    names = tuple(dict.fromkeys(name.strip() for name in listed.split(",") if name.strip()))
    if not names:
        raise UnknownNameError(f"--{what} names none: there are {', '.join(known)}")
    for name in names:
        if name not in known:
            raise UnknownNameError(f"no {what} `{name}`: there are {', '.join(known)}")
    return names


def _one_robot(campaign: Campaign, arguments: Namespace) -> str:
    return names_of(arguments.robot, tuple(campaign.robots), "robot")[0]


def _judged_by(arguments: Namespace) -> Campaign:
    """The campaign with the time that is given, and other requirements for all of its robots."""
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


def _as_asked(arguments: Namespace) -> Campaign:
    """The campaign as the options change it; wrong ones are refused before anything is played."""
    from rvmon.cdv.gate import refuse_unknown

    refuse_unknown(arguments.campaign(arguments))
    if arguments.junit is not None:
        refuse_no_file(arguments.junit)
    return _judged_by(arguments)


def _words(arguments: Namespace, *options: str) -> list[object]:
    """The command that does it again, with those options that were given."""
    words: list[object] = [arguments.command]
    for option in ("robot", *arguments.again, *options, "spec", "timeout"):
        value = getattr(arguments, option, None)
        if value:
            words += [f"--{option.replace('_', '-')}", *([] if value is True else [value])]
    return words


def _held(campaign: Campaign, judgement: CampaignJudgement, arguments: Namespace) -> bool:
    """Print, and write as JUnit XML, what a campaign came to; return whether all is as expected."""
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
