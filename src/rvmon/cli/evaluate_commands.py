"""The arguments of the commands that evaluate; separate from their work, so that help is fast."""

from __future__ import annotations

from rvmon.cli.options import EVALUATED, ONLY, READING, declare
from rvmon.cli.parser import TIME_FORMS, Subparsers, percentage, positive, shard, span, ticks
from rvmon.cli.reading import ATTEMPT_HELP
from rvmon.trace.time import TICKS_PER_SECOND


def add_run(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon run`."""
    parser = subparsers.add_parser(
        "run",
        description="Evaluate recordings (.csv, .jsonl, .parquet, ROS bags, .mcap, or - for JSON "
        "lines on standard input) against a specification: P passed, F failed, NT not triggered, "
        "I inconclusive. Exit code 0: no requirement failed; 1: one failed, or with --strict is I "
        "or NT; 2: wrong input.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv; rvmon run "
        "examples/base.rv examples/base.csv --only B2 --report pages --junit "
        "verdicts.xml",
    )
    parser.option("SPEC", "a .rv file, or a reproducer (.rvcase) that contains the other arguments")
    parser.option(
        "TRACE", "recordings: files, folders, patterns, addresses", nargs="+", dest="traces"
    )
    parser.option("--only IDS", "evaluate only these requirements: R1,R3")
    declare(parser, *ONLY[1:], *EVALUATED)
    parser.option(
        "--join",
        "join the files, or the files of a folder, by time into one recording; names are COLUMN "
        "or FILE.COLUMN",
    )
    parser.option("--jobs N", "number of processes (default: 1)", type=positive, default=1)
    declare(parser, "--dask")
    parser.option(
        "--robustness",
        "add the robustness of each attempt: by how much it passed or, if negative, failed (SI "
        "units)",
    )
    declare(parser, "--format")
    parser.option("--quiet", "print only the number of recordings for each verdict")
    parser.option(
        "--coverage DB",
        "add the coverage of the recordings to a database, which is created if needed; `rvmon "
        "cover DB` shows it",
    )
    parser.option(
        "--out FILE", "write the verdicts as a table, a row per attempt: .csv, .parquet, .sqlite"
    )
    parser.option(
        "--resume",
        "with --out: continue the same command where it was interrupted, or join its shards",
    )
    parser.option(
        "--shard I/N",
        "with --out: evaluate one share of the recordings, such as 2/4, and write it to its own "
        "file; the same command with --resume instead of --shard joins all shares",
        type=shard,
    )
    parser.option(
        "--known FILE", "TOML file of accepted failures, each with a reason and an expiry date"
    )
    parser.option(
        "--mcap FILE",
        "for one recording: write states, attempts and values over time as MCAP, with "
        "FILE.layout.json for Foxglove",
    )
    parser.option("--report DIR", "write an HTML page per recording")
    parser.option("--junit FILE", "write JUnit XML for CI")
    parser.option(
        "--evidence FILE",
        "keep recordings, specification and verdicts in one archive; `rvmon evidence FILE` checks "
        "it",
    )
    parser.option("--strict", "exit with 1 also if a requirement is I or NT")
    parser.option(
        "--require-triggered [=IDS]",
        "exit with 1 if one of these requirements (default: all) was triggered in no recording",
    )
    declare(parser, "--max-memory")


_LAG_NS = 500_000_000


def add_watch(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon watch`."""
    parser = subparsers.add_parser(
        "watch",
        description="Evaluate JSON lines as they arrive, and report each verdict as soon as it "
        "is decided; a missed deadline is reported when it has passed, not at the next line. A "
        "changed specification is loaded at once. Ends with the stream, or with Ctrl-C. Exit "
        "code 0: every requirement is P or NT; 1: one failed or is I, or there was no input; 2: "
        "wrong input.",
        epilog='example: printf \'{"t":0,"speed":0.5,"obstacle":0.4}\\n\' | '
        "rvmon watch examples/base.rv",
    )
    declare(parser, "SPEC")
    parser.option(
        "SOURCE",
        "a pipe or file of JSON lines (default: standard input); mqtt://HOST/TOPICS, such as "
        "mqtt://localhost/robots/+/#, where the first + is the name of the robot; ros1: (ROS 1 "
        "topics); ros2: (ROS 2 topics); or dds:DOMAIN (ROS 2 topics without a ROS installation). "
        "Lines with a time stamp (t, t_ns, --time) are evaluated at that time, others when they "
        "arrive",
        nargs="?",
        default="-",
    )
    declare(parser, *ONLY, "--const", "--time", "--map", "--binding")
    parser.option(
        "--robot FIELD", "the field that names the robot; each robot has its own monitors"
    )
    parser.option(
        "--publish TOPIC",
        "publish each verdict as JSON: over MQTT under TOPIC/REQUIREMENT, over ROS on TOPIC",
    )
    parser.option(
        "--realtime TIME",
        "the stamps of the lines are the time of day since 1970, and lines arrive at most "
        f"TIME later ({TIME_FORMS}; default: 500ms), so deadlines pass even if no line arrives",
        nargs="?",
        type=span,
        const=_LAG_NS,
    )
    parser.option(
        "--sim-time",
        "take the time from the topic /clock; the default for ros1: if the parameter "
        "`use_sim_time` is true",
    )
    parser.option(
        "--room N",
        "length of the input queue in lines (default: 10000); further lines are counted as lost",
        type=positive,
        default=10_000,
    )
    parser.option(
        "--state FILE",
        "keep the run in a file: after a crash the same command continues it. Verdicts are "
        "numbered; the latest may be reported twice",
    )
    parser.option("--failures", "report failures only")
    parser.option(
        "--format",
        "a live table (default on a terminal), a line for each verdict, or JSON lines",
        choices=("view", "text", "json"),
    )


def add_why(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon why`."""
    parser = subparsers.add_parser(
        "why",
        description="Explain one attempt: show when each part of its requirement was true.",
        epilog="example: rvmon why examples/base.rv examples/base.csv B2#2",
    )
    parser.option("SPEC", "a .rv file, or a reproducer (.rvcase) that contains the other arguments")
    parser.option("TRACE", "a recording, as `rvmon run` takes it")
    parser.option("ID#N", ATTEMPT_HELP, dest="attempt")
    declare(parser, *EVALUATED, "--format")


def add_clip(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon clip`."""
    parser = subparsers.add_parser(
        "clip",
        description="Cut a recording around an attempt, in the recording's own format. The last "
        "values of signals before the cut are carried to its start. The cut is evaluated again; "
        "the exit code is 1 if the attempt gets another verdict.",
        epilog="example: rvmon clip examples/base.rv examples/base.csv B2#2 --before 1s -o "
        "piece.csv",
    )
    declare(parser, "SPEC", "DATA")
    parser.option("ID#N", ATTEMPT_HELP, nargs="?", dest="attempt")
    parser.option(
        "--before TIME",
        f"start TIME ({TIME_FORMS}; default: 10s) before the trigger, or before the failure "
        "within an episode",
        type=span,
        default=10 * TICKS_PER_SECOND,
    )
    parser.option(
        "--after TIME",
        f"end TIME ({TIME_FORMS}; default: 5s) after the decision, or at the next sample if "
        "that is later",
        type=span,
        default=5 * TICKS_PER_SECOND,
    )
    parser.option("--from TIME", f"first instant ({TIME_FORMS})", type=ticks, dest="start")
    parser.option("--to TIME", f"last instant ({TIME_FORMS})", type=ticks, dest="stop")
    parser.option("-o --out FILE", "the cut recording; a folder for a ROS 2 bag")
    parser.option(
        "--reproducer FILE",
        "one file (.rvcase) with the cut recording and the specification: `rvmon why FILE` "
        "explains the attempt, `rvmon run FILE` evaluates it; -o FILE.rvcase is the same",
    )
    declare(parser, "--const", *READING, "--allow-missing")


def add_compare(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon compare`."""
    parser = subparsers.add_parser(
        "compare",
        description="Compare the verdicts on recordings with earlier ones, by recording and "
        "requirement: new failures, fixed failures, verdicts that are missing now. The files are "
        "written by `rvmon run --out` (.csv, .parquet, .sqlite) or `--format json` (.json). The "
        "exit code is 1 if a requirement got worse.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv --out old.csv; rvmon "
        "compare old.csv old.csv",
    )
    parser.option("OLD", "the earlier verdicts", dest="before")
    parser.option("NEW", "the later verdicts", dest="after")
    parser.option("--all", "list all differences")
    declare(parser, "--format")


def add_cover(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon cover`."""
    parser = subparsers.add_parser(
        "cover",
        description="Show what the tests of one or several coverage databases have covered "
        "together: problems first, then groups, total and verdicts.",
        epilog="examples: rvmon run examples/base.rv examples/base.csv --coverage base.cov; "
        "rvmon cover base.cov --holes",
    )
    parser.option(
        "DB", "coverage databases, written by run --coverage", nargs="+", dest="databases"
    )
    parser.option("--campaign NAME", "show the tests of this campaign only")
    parser.option("--holes", "list the items that are missing or cannot be hit, with the reasons")
    parser.option(
        "--bins [=GROUP]",
        "list the items of a group (default: of all), with hits and the first test that hit them; "
        "a cross is shown as a grid",
    )
    parser.option(
        "--tests",
        "list the tests with their contributions, and a short sequence of tests with the same "
        "coverage",
    )
    parser.option(
        "--compare OLD",
        "show items and verdicts that changed since an earlier database, or an earlier campaign "
        "in this one",
    )
    declare(parser, "--format")
    parser.option("--report FILE", "write an HTML page")
    parser.option("--ucis FILE", "write the coverage as UCIS XML, for other tools")
    parser.option("--merge OUT", "merge the databases into this one")
    parser.option(
        "--require PERCENT",
        "exit with 1 if less is covered, or if an item was hit that is illegal or declared "
        "unreachable",
        type=percentage,
    )
    parser.option(
        "--strict",
        "exit with 1 if an item was hit that is illegal or declared unreachable, if a test failed "
        "or did not complete, or if --compare shows a loss",
    )
    declare(parser, "--max-memory")


def add_evidence(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon evidence`."""
    parser = subparsers.add_parser(
        "evidence",
        help="check an evidence archive",
        description="Check that an evidence archive (`--evidence FILE`) is unchanged and that "
        "the recordings are the evaluated ones, and evaluate a sample of them again. Exit codes: "
        "0 all checks passed, 1 one failed, 2 something could not be checked.",
        epilog="example: %(prog)s base.zip --sample all",
    )
    parser.option("FILE", "the archive")
    parser.option(
        "--sample N",
        "number of recordings or tests to evaluate again, or all (%(default)s)",
        type=lambda text: None if text == "all" else positive(text),
        default=10,
    )
    parser.option("--seed N", "random seed of the sample (1)", type=int, default=1)
    parser.option("--jobs N", "number of processes (1)", type=positive, default=1)
    parser.set_defaults(campaign=None)
