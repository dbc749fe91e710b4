"""The arguments of the commands for writing requirements, apart from their work."""

from __future__ import annotations

from rvmon.cli.options import READING, declare
from rvmon.cli.parser import TIME_FORMS, Subparsers, positive, span_s


def add_look(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon look`."""
    parser = subparsers.add_parser(
        "look",
        description="Show every signal and event of a recording over time: kind, unit, rate, "
        "longest gap, range and losses. With a specification, the signals and events that its "
        "requirements read come first.",
        epilog="examples: rvmon look examples/base.csv; "
        "rvmon look examples/base.csv examples/base.rv -o look.html",
    )
    add = parser.add_argument
    add("data", metavar="DATA", help="a recording, as `rvmon run` takes it")
    add("spec", metavar="SPEC", nargs="?", help="a .rv file")
    parser.option("-o --output FILE", "write an HTML page instead")
    declare(parser, "--const", *READING)


def add_init(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon init`."""
    parser = subparsers.add_parser(
        "init",
        description="Write a starter specification from a recording: signals with guessed types, "
        "ranges and rates, events, and requirements that can be evaluated as they stand. With "
        "--for, propose a binding (TOML) that maps topics and fields of a bag or MCAP file to "
        "the names of a specification, by message type, unit and name, with the values that "
        "occur; names without a clear match are left open, and the exit code is then 1. With "
        "--campaign, write a test campaign that runs as it stands, to be adapted to your own "
        "system.",
        epilog="examples: rvmon init examples/base.csv -o mine.rv; rvmon init --campaign mine; "
        "rvmon init monday.bag --for base.rv > base.toml && rvmon run base.rv monday.bag --binding "
        "base.toml",
    )
    add = parser.add_argument
    add("data", metavar="DATA", nargs="?", help="a recording, as `rvmon run` takes it")
    parser.option("--for SPEC", "propose a binding for this specification", dest="spec")
    declare(parser, "--const")
    parser.option(
        "--campaign DIR",
        "write a campaign into this folder: code under test, its environment, requirements, "
        "strategies",
    )
    parser.option(
        "-o --output FILE",
        "output file, - for standard output (default: the name of DATA, with .rv)",
    )
    declare(parser, "--time")
    parser.option("--force", "overwrite an existing file")


def add_check(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon check`."""
    parser = subparsers.add_parser(
        "check",
        description="Report all errors and warnings of each specification.",
        epilog="examples: rvmon check examples/base.rv; rvmon check specs/*.rv --format concise",
    )
    add = parser.add_argument
    add("specs", metavar="SPEC", nargs="+", help=".rv files, - for standard input")
    declare(parser, "--const", "--binding")
    parser.option(
        "--format",
        "how to print findings: in full, one line each, or as JSON, which has a line for each as "
        "well (default: text)",
        choices=("text", "concise", "json"),
        default="text",
    )
    parser.option("--strict", "exit with 1 if there are warnings")
    parser.option(
        "--analyse",
        "look for requirements that can never trigger, fail or pass, that conflict, or that "
        "others imply",
    )
    parser.option(
        "--seconds TIME",
        f"budget of --analyse per file ({TIME_FORMS}; default: 8)",
        type=span_s,
        default=8.0,
    )
    declare(parser, "--max-memory")


def add_explain(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon explain`."""
    parser = subparsers.add_parser(
        "explain",
        description="Explain a requirement: in plain words, with its automaton and the shortest "
        "runs on which it passes, fails, is not triggered or stays open. Of two requirements, "
        "show where they differ. Of a diagnostic code such as RV012, show its page; `codes` "
        "lists all codes.",
        epilog="examples: rvmon explain examples/base.rv B2; rvmon explain RV001",
    )
    add = parser.add_argument
    add("subject", metavar="SPEC|CODE", help="a .rv file, or a code such as RV012")
    add("ids", metavar="ID", nargs="*", help="one requirement, or two (default: all)")
    declare(parser, "--const")
    parser.option(
        "--runs N",
        "number of short runs to try (default: 4000)",
        type=positive,
        default=4000,
    )
    declare(parser, "--max-memory")


def add_format(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon format`."""
    parser = subparsers.add_parser(
        "format",
        description="Rewrite specifications in the canonical layout; meaning and comments are "
        "kept. With - as SPEC, standard input is formatted to standard output.",
        epilog="example: rvmon format --check specs/*.rv",
    )
    parser.add_argument("specs", metavar="SPEC", nargs="+", help=".rv files")
    parser.option("--check", "do not write; exit with 1 if a file would change")


def add_lsp(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon lsp`."""
    parser = subparsers.add_parser(
        "lsp",
        description="Serve an editor over standard input and output by the Language Server "
        "Protocol: findings, explanations, definitions, names and units, layout. It ends when the "
        "editor does.",
        epilog="example: rvmon lsp --stdio",
    )
    parser.option("--stdio", "accepted for editors that pass it; it is the default")
