"""The arguments of the commands on specifications and models; separate, so that help is fast."""

from __future__ import annotations

from rvmon.cli.options import ONLY, READING, add_budget, declare
from rvmon.cli.parser import TIME_FORMS, Subparsers, positive, span, span_s


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
    declare(parser, "DATA")
    parser.option("SPEC", "a .rv file", nargs="?")
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
    parser.option("DATA", "a recording, as `rvmon run` takes it", nargs="?")
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
    parser.option("SPEC", ".rv files, - for standard input", nargs="+", dest="specs")
    declare(parser, "--const", "--binding")
    parser.option(
        "--format",
        "how to print findings: in full (default), on one line each, or as JSON with one line each",
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
        "runs on which it passes, fails, is not triggered or stays open. For two requirements, "
        "show where they differ. For a diagnostic code such as RV012, show its page; `codes` "
        "lists all codes.",
        epilog="examples: rvmon explain examples/base.rv B2; rvmon explain RV001",
    )
    parser.option("SPEC|CODE", "a .rv file, or a code such as RV012", dest="subject")
    parser.option("ID", "one requirement, or two (default: all)", nargs="*", dest="ids")
    declare(parser, "--const")
    parser.option(
        "--runs N", "number of short runs to try (default: 4000)", type=positive, default=4000
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
    parser.option("SPEC", ".rv files", nargs="+", dest="specs")
    parser.option("--check", "do not write; exit with 1 if a file would change")


def add_lsp(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon lsp`."""
    parser = subparsers.add_parser(
        "lsp",
        description="Serve an editor over standard input and output by the Language Server "
        "Protocol: diagnostics, explanations, definitions, completion and layout. It ends when "
        "the editor does.",
        epilog="example: rvmon lsp --stdio",
    )
    parser.option("--stdio", "accepted for editors that pass it; it is the default")


def add_verify(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon verify`."""
    parser = subparsers.add_parser(
        "verify",
        description="Decide queries on a network of timed automata (.ta, or UPPAAL's .xml), each "
        "with a timed run that shows why. Exit code 0: all hold; 1: one does not, or the search "
        "stopped at a limit.",
        epilog="example: rvmon verify examples/models/train_gate.ta --query 'A[] not "
        "deadlock' --trace fastest",
    )
    declare(parser, "MODEL")
    parser.option(
        "--query Q", "a query, or the id of one in the model (default: all)", action="append"
    )
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--spec",
        metavar="SPEC",
        help="check the requirements of a specification on all runs instead",
    )
    parser.option(
        "--bind NAME=EXPR",
        "the model expression that is the value of a signal of the specification",
        action="append",
        default=[],
    )
    instead.add_argument(
        "--suite",
        choices=("locations", "edges", "edge-pairs"),
        help="show a small set of runs that covers all of these instead",
    )
    parser.option("--seed N", "random seed of simulated runs", type=int, default=1)
    parser.option(
        "--trace",
        "which of several runs to show (default: shortest)",
        choices=("shortest", "fastest", "likely"),
        default="shortest",
    )
    parser.option("--const NAME=N", "set a constant of the model", action="append", default=[])
    declare(parser, "--format")
    add_budget(parser)


def add_conform(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon conform`."""
    parser = subparsers.add_parser(
        "conform",
        description="Decide whether recordings (.csv, .jsonl) are runs of a network of timed "
        "automata; their events are labels of its edges, or its channels. The first sample is "
        "the network's start. Exit code 0: all conform; 1: one does not, or is not decided; 2: a "
        "recording cannot be read, or contains no action of the model.",
        epilog="example: rvmon conform examples/models/dock.ta examples/models/dock_monday.csv",
    )
    declare(parser, "MODEL")
    parser.option("TRACE", "recordings, or folders of recordings", nargs="+", dest="traces")
    declare(parser, "--time")
    parser.option(
        "--observe LABELS",
        "labels that are observed (default: those that have a column, or that occur)",
    )
    parser.option(
        "--tolerance TIME",
        f"by how much an action may be early or late ({TIME_FORMS}; default: 0)",
        type=span,
        default=0,
    )
    parser.option(
        "--until TIME",
        f"compare up to TIME ({TIME_FORMS}) after the first sample, whether the recording is "
        "longer or shorter",
        type=span,
    )
    declare(parser, "--format")
    add_budget(parser)


def add_export(subparsers: Subparsers) -> None:
    """Declare the arguments of `rvmon export`."""
    parser = subparsers.add_parser(
        "export",
        description="From a specification, write a monitor that does not need rvmon: C99 sources "
        "(the core, the compiled specification, a header for C++) that run in one block of "
        "memory. Or write its automata: dot for Graphviz, json, or hoa (the minimal LTL3 "
        "monitors of requirements without time windows); a requirement without an automaton is "
        "left out, with the reason. From a model, write dot, or XML for UPPAAL.",
        epilog="examples: rvmon export examples/base.rv --to c -o monitor/; rvmon export "
        "examples/base.rv --to dot --only B1 | dot -Tsvg -o b1.svg; rvmon export "
        "examples/models/fischer.ta --to uppaal -o fischer.xml",
    )
    parser.option("SPEC|MODEL", "a .rv file; or a .ta or .xml file", dest="subject")
    parser.add_argument("--to", choices=("c", "dot", "json", "hoa", "uppaal"), required=True)
    parser.option("-o --output PATH", "output folder (c) or file (default: standard output)")
    declare(parser, *ONLY, "--const")
