"""The arguments of `rvmon run`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import EVALUATED, ONLY, declare
from rvmon.cli.parser import positive, shard


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "run",
        description="Evaluate recordings (.csv, .jsonl, .parquet, bags of ROS, .mcap, or - for "
        "JSON lines on standard input) against a specification: P passed, F failed, NT not "
        "triggered, I inconclusive. Exit code 0: no requirement failed; 1: one failed, or with "
        "--strict is I or NT; 2: wrong input.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv; rvmon run "
        "examples/base.rv examples/base.csv --only B2 --report pages --junit "
        "verdicts.xml",
    )
    add = parser.add_argument
    add(
        "spec",
        metavar="SPEC",
        help="a .rv file, or a reproducer (.rvcase) that contains the other arguments",
    )
    add(
        "traces", metavar="TRACE", nargs="+", help="recordings: files, folders, patterns, addresses"
    )
    add("--only", metavar="IDS", help="evaluate only these requirements: R1,R3")
    declare(parser, *ONLY[1:], *EVALUATED)
    add(
        "--join",
        action="store_true",
        help="join the files, or those of the folder, by time into one recording; names are "
        "COLUMN or FILE.COLUMN",
    )
    add("--jobs", metavar="N", type=positive, default=1, help="number of processes (default: 1)")
    declare(parser, "--dask")
    add(
        "--robustness",
        action="store_true",
        help="add the robustness of each attempt: by how much it passed or, if negative, failed "
        "(SI units)",
    )
    declare(parser, "--format")
    add("--quiet", action="store_true", help="print only the number of recordings for each verdict")
    add(
        "--coverage",
        metavar="DB",
        help="add the coverage of the recordings to a database, which is created if needed; "
        "`rvmon cover DB` shows it",
    )
    add(
        "--out",
        metavar="FILE",
        help="write the verdicts as a table, a row per attempt: .csv, .parquet, .sqlite",
    )
    add(
        "--resume",
        action="store_true",
        help="with --out: continue the same command where it was interrupted, or join its shards",
    )
    add(
        "--shard",
        metavar="I/N",
        type=shard,
        help="with --out: evaluate one share of the recordings, such as 2/4, into a file of its "
        "own; the same command with --resume instead joins all shares",
    )
    add(
        "--known",
        metavar="FILE",
        help="TOML file of accepted failures, each with a reason and an expiry date",
    )
    add(
        "--mcap",
        metavar="FILE",
        help="for one recording: write states, attempts and values over time as MCAP, with "
        "FILE.layout.json for Foxglove",
    )
    add("--report", metavar="DIR", help="write an HTML page per recording")
    add("--junit", metavar="FILE", help="write JUnit XML for CI")
    add(
        "--evidence",
        metavar="FILE",
        help="keep recordings, specification and verdicts in one archive; `rvmon evidence FILE` "
        "checks it",
    )
    add("--strict", action="store_true", help="exit with 1 also if a requirement is I or NT")
    add(
        "--require-triggered",
        metavar="[=IDS]",
        help="exit with 1 if one of these requirements (default: any) was triggered in no "
        "recording",
    )
    declare(parser, "--max-memory")
