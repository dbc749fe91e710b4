"""The options of a campaign's commands: tests, how they are played, where results go."""

from __future__ import annotations

from argparse import ArgumentParser

from rvmon.cli.options import declare
from rvmon.cli.parser import TIME_FORMS, number_or_folder, positive, shard, span_s


def add_run_options(parser: ArgumentParser) -> None:
    """Declare how many tests are played, and where their results go."""
    add = parser.add_argument
    add("--tests", metavar="N", type=positive, default=100, help="of each random strategy (100)")
    add("--suite", metavar="DIR", help="play the tests of this folder in the place of strategies'")
    add("--evidence", metavar="FILE", help="keep tests, verdicts and specifications in one archive")
    add(
        "--shard",
        metavar="I/N",
        type=shard,
        help="with --out, play this share, as 2/4; the same without it joins what shards left",
    )
    add(
        "--strict",
        action="store_true",
        help="exit with 1 as well if something is inconclusive, is never triggered though its "
        "strategy has to, or too little is covered",
    )
    _add_playing_options(parser)


def _add_playing_options(parser: ArgumentParser) -> None:
    _add_seed_and_jobs(parser)
    declare(parser, "--dask")
    _add_timeout(parser)
    add = parser.add_argument
    add("--junit", metavar="FILE", help="write what was expected, and what came out, as JUnit XML")
    add(
        "--out",
        metavar="DIR",
        help="write tables, tests and pages there; a campaign that was ended there goes on",
    )
    add(
        "--pages",
        choices=("examples", "all"),
        default="examples",
        help="of which runs to write a page: an example of each count, or all (%(default)s)",
    )


def add_closing_options(parser: ArgumentParser) -> None:
    """Declare when closing gives up, and where the suite goes."""
    add = parser.add_argument
    add("--tests", metavar="N", type=positive, default=400, help="play at most so many (400)")
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
        help="keep so many tests that show each goal, where so many were found (2): one covers it, "
        "more see more faults",
    )
    add(
        "--mutants",
        metavar="N",
        type=positive,
        help="keep also the fewest tests that kill what the suite does not of so many mutants of "
        "the code, and show what each choice of tests sees of them and of those held out",
    )
    _add_playing_options(parser)


def add_replay_options(parser: ArgumentParser) -> None:
    """Declare where the run of a test goes."""
    add = parser.add_argument
    add("--out", metavar="DIR", help="write the recording and a page there")
    add("--mcap", metavar="FILE", help="write verdicts, values and the scene for Foxglove")
    add("--expected", action="store_true", help="exit with 0 if all came out as the test expects")


def add_shrink_options(parser: ArgumentParser) -> None:
    """Declare by which failure a test is shrunk, and where it goes."""
    parser.add_argument(
        "--requirement", metavar="ID", help="that is to fail (default: the first that does)"
    )
    _add_timeout(parser)
    parser.add_argument(
        "--out", metavar="DIR", help="write it there, with a test of pytest that replays it"
    )


def add_mutate_options(parser: ArgumentParser) -> None:
    """Declare which mutants are played by which tests, and where results go."""
    add = parser.add_argument
    add(
        "--tests",
        metavar="N|DIR",
        type=number_or_folder,
        default=100,
        help="of each random strategy (100); or a folder of tests, which is the suite",
    )
    _add_seed_and_jobs(parser)
    _add_timeout(parser)
    add(
        "--of",
        choices=("code", "spec", "both"),
        default="both",
        help="mutants of the code, of its requirements, or %(default)s (default)",
    )
    add("--only", metavar="TEXT", default="", help="mutants whose name has this")
    add("--all", action="store_true", help="play all tests, also after a requirement failed")
    add("--held-out", action="store_true", help="show also single mutants that are held out")
    add("--list", action="store_true", help="list the mutants, and play nothing")
    add("--strict", action="store_true", help="exit with 1 unless all mutants are killed")
    add("--out", metavar="DIR", help="write mutation.html, mutation.json and mutation.txt there")


def _add_seed_and_jobs(parser: ArgumentParser) -> None:
    parser.add_argument("--seed", metavar="N", type=int, default=1, help="all follows from it (1)")
    parser.add_argument("--jobs", metavar="N", type=positive, help="processes (default: all cores)")


def _add_timeout(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--timeout",
        metavar="TIME",
        type=span_s,
        help=f"end a test that takes longer ({TIME_FORMS}; default: 600)",
    )


def add_judging_options(parser: ArgumentParser) -> None:
    """Declare what judges, and in which form verdicts are printed."""
    parser.add_argument("--spec", metavar="FILE", help="check against these requirements")
    declare(parser, "--format")
