"""`rvmon prepare`: compile ahead what `auto` has beside it in streams, and what `c` runs."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from itertools import count

from rvmon.cli.options import add_const, add_only, asked_ids, constants_of
from rvmon.cli.progress import bar
from rvmon.cli.say import say, say_json


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "prepare",
        help="compile ahead what makes streams fast, and what the engine c runs",
        description="Compile a specification ahead (by a C compiler: $CC, cc, gcc or clang). "
        "Streams are then evaluated several times faster by the engine auto, with the same "
        "reports, and the engine c starts at once; on the same machine without a compiler as "
        "well. The files are kept in the cache. rvmon check --engines shows what auto does not "
        "take.",
        epilog="examples: rvmon prepare examples/base.rv; rvmon run examples/base.rv "
        "examples/base.csv --engine c",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument(
        "--robustness", action="store_true", help="also what measures robustness in streams"
    )
    add_only(parser)
    add_const(parser)
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help="for people, or as data"
    )


def run(arguments: argparse.Namespace) -> int:
    """Compile, say what is ready, and return the exit code."""
    from rvmon.loading import load
    from rvmon.monitor.c.prepare import USES
    from rvmon.report.plain_table import plain_table

    spec = load(arguments.spec, const=constants_of(arguments.const))
    ids, done = asked_ids(arguments, spec), count(1)
    with bar("compiling", len(USES) - (not arguments.robustness)) as show:
        found = spec.prepare(
            only=ids, ready=lambda _: show(next(done)), robustness=arguments.robustness
        )
    if arguments.format == "json":
        import json

        say_json(json.dumps([{**asdict(one), "path": str(one.path)} for one in found], indent=1))
        return 0
    rows = [(one.use, f"{one.seconds:.1f} s", _size(one.size), str(one.path)) for one in found]
    say(plain_table([("for", "took", "size", "file"), *rows]).rstrip())
    refused = {name: one.refused.get("prepared") for name, one in spec.engines(only=ids).items()}
    if any(refused.values()):
        count_taken = sum(one is None for one in refused.values())
        say(f"auto judges {count_taken} of {len(refused)} requirements in C; in Python:")
        for name, refusal in refused.items():
            if refusal:
                say(f"  {name}: {refusal.reason}")
    return 0


def _size(size: int) -> str:
    return f"{(size + 999) // 1000} kB"
