"""The command `mutate` of a campaign: which small wrong changes do its tests see?"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.documents import to_json
from rvmon.cdv.files import load
from rvmon.cdv.plan import plan
from rvmon.cli.campaign import add_judging_options, judged_by, names_of
from rvmon.cli.numbers import positive
from rvmon.cli.progress import bar
from rvmon.cli.say import say, say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.report.folder import made
from rvmon.writing import write_whole

MOST_LISTED = 10
"""Survivors of a kind that the terminal shows; files have all."""


def add_mutate_options(parser: argparse.ArgumentParser) -> None:
    """Declare which mutants are played by which tests, and where results go."""
    parser.add_argument(
        "--strategy", metavar="NAMES", help="suites: the tests of each of these (default: all)"
    )
    parser.add_argument(
        "--tests",
        metavar="N|DIR",
        default="100",
        help="of each random strategy (100); or a folder of tests, which is the suite",
    )
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the tests (1)")
    parser.add_argument("--jobs", metavar="N", type=positive, help="processes (default: all cores)")
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
    parser.add_argument("--out", metavar="DIR", help="write survivors.txt and mutation.json there")
    add_judging_options(parser)


def mutate(campaign: Campaign, robot: str, arguments: argparse.Namespace) -> int:
    """Play suites on mutants of a robot's code, show and keep the scores, return an exit code.

    Args:
        campaign: that the tests are of.
        robot: its name.
        arguments: those of `add_mutate_options`.
    """
    from rvmon.cdv.mutation.equivalent import equivalents
    from rvmon.cdv.mutation.find import code_mutants
    from rvmon.cdv.mutation.play import play_mutants
    from rvmon.cdv.mutation.question import readers
    from rvmon.cdv.mutation.report import ALL, MutationReport, SuiteTried
    from rvmon.cdv.mutation.suite import mutated_code, record_suite
    from rvmon.cdv.mutation.text import list_text, report_text

    campaign = judged_by(campaign, arguments.spec)
    code = mutated_code(campaign)
    mutants = code_mutants(code)
    equivalent = {} if code.equivalent is None else equivalents(code.equivalent, mutants)
    mutants = [one for one in mutants if arguments.only in one.identity]
    if not mutants:
        raise UnknownNameError(f"no mutant has `{arguments.only}` in its name: --list lists all")
    if arguments.list:
        say(list_text(mutants, held_out=arguments.held_out), end="")
        return 0
    folder = made(arguments.out) if arguments.out else None
    jobs = arguments.jobs or os.cpu_count() or 1
    begun = time.perf_counter()
    suites = {}
    for name, tests in _suites(campaign, arguments).items():
        with bar(f"{name}: tests", len(tests)) as tell:
            suite = record_suite(campaign, robot, tests, jobs=jobs, progress=tell)
        with bar(f"{name}: mutants", len(mutants)) as tell:
            tried = play_mutants(suite, mutants, jobs=jobs, every=arguments.all, progress=tell)
        suites[name] = SuiteTried(len(suite.tests), suite.left_out, tuple(tried))
    report = MutationReport(
        campaign.name,
        campaign.robots[robot].title or robot,
        suites,
        equivalent,
        readers(suite.spec.checked),
        shows_held_out=arguments.held_out,
        seconds=time.perf_counter() - begun,
    )
    if arguments.format == "json":
        say_json(to_json(report.document()).decode().removesuffix("\n"))
    else:
        is_short = folder is not None or sys.stdout.isatty()
        say(report_text(report, most=MOST_LISTED if is_short else None))
        say(f"{len(mutants)} mutants in {report.seconds:.1f} s.")
    if folder is not None:
        write_whole(folder / "mutation.txt", report_text(report))
        write_whole(folder / "mutation.json", to_json(report.document()))
    wrong = report.contradictions()
    for what in wrong:
        warn(what)
    scores = [report.scores(name)[ALL] for name in suites]
    survives = any(one.killed < one.rest for one in scores)
    return int(bool(wrong) or (arguments.strict and survives))


def _suites(campaign: Campaign, arguments: argparse.Namespace) -> dict[str, Sequence[Test]]:
    """The tests of each suite, by its name."""
    if not arguments.tests.isascii() or not arguments.tests.isdigit():
        if arguments.strategy is not None:
            raise RvmonError(f"--tests {arguments.tests} is a suite by itself: omit --strategy")
        paths = sorted(Path(arguments.tests).glob("*.json"))
        if not paths:
            raise RvmonError(f"no test in {arguments.tests}: name a folder of .json files")
        return {Path(arguments.tests).name: [load(path, campaign.test) for path in paths]}
    count = positive(arguments.tests)
    names = names_of(arguments.strategy, tuple(campaign.strategies), "strategy")
    return dict(plan(campaign, names, tests=count, seed=arguments.seed).tests)
