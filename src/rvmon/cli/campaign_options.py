"""The options of a campaign's commands: tests, how they are played, where results go."""

from __future__ import annotations

from argparse import ArgumentParser

from rvmon.cli.options import declare
from rvmon.cli.parser import TIME_FORMS, number_or_folder, positive, shard, span_s


def add_run_options(parser: ArgumentParser) -> None:
    """Declare how many tests are played, and where their results go."""
    add = parser.add_argument
    add(
        "--tests",
        metavar="N",
        type=positive,
        default=100,
        help="number of tests of each random strategy (100)",
    )
    add("--suite", metavar="DIR", help="play the tests of this folder instead of generated ones")
    add("--evidence", metavar="FILE", help="keep tests, verdicts and specifications in one archive")
    add(
        "--shard",
        metavar="I/N",
        type=shard,
        help="with --out: play one share of the tests, such as 2/4; the same command without "
        "--shard joins the shares",
    )
    add(
        "--strict",
        action="store_true",
        help="exit with 1 also if a requirement is inconclusive, if one was never triggered by a "
        "strategy that must trigger it, or if coverage is too low",
    )
    _add_playing_options(parser)


def _add_playing_options(parser: ArgumentParser) -> None:
    _add_seed_and_jobs(parser)
    declare(parser, "--dask")
    _add_timeout(parser)
    add = parser.add_argument
    add("--junit", metavar="FILE", help="write expected and actual verdicts as JUnit XML")
    add(
        "--out",
        metavar="DIR",
        help="write tables, tests and pages into this folder; an interrupted campaign is continued",
    )
    add(
        "--pages",
        choices=("examples", "all"),
        default="examples",
        help="runs to write pages of: an example of each verdict, or all (%(default)s)",
    )


def add_closing_options(parser: ArgumentParser) -> None:
    """Declare when closing gives up, and where the suite goes."""
    add = parser.add_argument
    add("--tests", metavar="N", type=positive, default=400, help="play at most N tests (400)")
    add(
        "--seconds",
        metavar="TIME",
        type=span_s,
        help=f"begin no test after TIME ({TIME_FORMS}; default: any)",
    )
    add(
        "--margin",
        metavar="N",
        type=positive,
        default=2,
        help="keep up to N tests for each goal (2): one covers it, more detect more faults",
    )
    add(
        "--mutants",
        metavar="N",
        type=positive,
        help="also keep a smallest set of tests that kills further mutants, out of N mutants of "
        "the code, and show how many of these and of the held-out mutants each selection of "
        "tests kills",
    )
    _add_playing_options(parser)


def add_replay_options(parser: ArgumentParser) -> None:
    """Declare where the run of a test goes."""
    add = parser.add_argument
    add("--out", metavar="DIR", help="write the recording and a page into this folder")
    add("--mcap", metavar="FILE", help="write verdicts, values and the scene for Foxglove")
    add(
        "--expected",
        action="store_true",
        help="exit with 0 if all verdicts are as the test expects",
    )


def add_shrink_options(parser: ArgumentParser) -> None:
    """Declare by which failure a test is shrunk, and where it goes."""
    parser.add_argument(
        "--requirement",
        metavar="ID",
        help="the requirement that has to fail (default: the first that does)",
    )
    _add_timeout(parser)
    parser.add_argument(
        "--out", metavar="DIR", help="write it into this folder, with a pytest test that replays it"
    )


def add_mutate_options(parser: ArgumentParser) -> None:
    """Declare which mutants are played by which tests, and where results go."""
    add = parser.add_argument
    add(
        "--tests",
        metavar="N|DIR",
        type=number_or_folder,
        default=100,
        help="number of tests of each random strategy (100), or a folder of tests",
    )
    _add_seed_and_jobs(parser)
    _add_timeout(parser)
    add(
        "--of",
        choices=("code", "spec", "both"),
        default="both",
        help="mutate the code, its requirements, or %(default)s (default)",
    )
    add("--only", metavar="TEXT", default="", help="only mutants whose name contains this")
    add("--all", action="store_true", help="play all tests, even after a requirement has failed")
    add("--held-out", action="store_true", help="also list the held-out mutants one by one")
    add("--list", action="store_true", help="list the mutants without playing tests")
    add("--strict", action="store_true", help="exit with 1 unless all mutants are killed")
    add(
        "--out",
        metavar="DIR",
        help="write mutation.html, mutation.json and mutation.txt into this folder",
    )


def _add_seed_and_jobs(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--seed", metavar="N", type=int, default=1, help="random seed of everything (1)"
    )
    parser.add_argument(
        "--jobs", metavar="N", type=positive, help="number of processes (default: all cores)"
    )


def _add_timeout(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--timeout",
        metavar="TIME",
        type=span_s,
        help=f"end a test that takes longer ({TIME_FORMS}; default: 600)",
    )


def add_judging_options(parser: ArgumentParser) -> None:
    """Declare what judges, and in which form verdicts are printed."""
    parser.add_argument("--spec", metavar="FILE", help="evaluate these requirements")
    declare(parser, "--format")
