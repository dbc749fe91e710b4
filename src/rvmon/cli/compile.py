"""`rvmon compile`: a specification as code that runs elsewhere, or as a graph."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rvmon.errors import RvmonError


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "compile",
        help="a specification as Python or C that runs alone",
        description="Write a monitor that needs nothing of rvmon: one Python file, or C99 (a "
        "header, a source, a header for C++) that allocates nothing.",
        epilog="example: rvmon compile specs/handover.rv --to c -o monitor/",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument("--to", choices=("python", "c"), required=True)
    parser.add_argument(
        "-o", "--output", metavar="PATH", help="a file (python; default: print it) or folder (c)"
    )
    parser.add_argument("--only", metavar="IDS", help="these requirements: R1,R3")
    parser.add_argument(
        "--const", metavar="NAME=VALUE", action="append", default=[], help="override a constant"
    )


def run(arguments: argparse.Namespace) -> int:
    """Generate and write, and return the exit code."""
    from rvmon.cli.constants import constants_of
    from rvmon.session import load

    spec = load(arguments.spec, const=constants_of(arguments.const))
    ids = None if arguments.only is None else [name.strip() for name in arguments.only.split(",")]
    plan = spec.plan(only=ids)
    if arguments.to == "python":
        from rvmon.codegen.python_file import python_file

        _write_or_print(python_file(plan), arguments.output)
        return 0
    from rvmon.codegen.c_source import c_files

    if arguments.output is None:
        raise RvmonError("C is several files: name a folder with -o DIR")
    folder = Path(arguments.output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in c_files(plan).texts.items():
            (folder / name).write_text(text, encoding="utf-8")
            print(folder / name)
    except OSError as error:
        raise RvmonError(f"cannot write to {folder}: {error.strerror}") from None
    return 0


def _write_or_print(text: str, output: str | None) -> None:
    if output is None:
        sys.stdout.write(text)
        return
    try:
        Path(output).write_text(text, encoding="utf-8")
    except OSError as error:
        raise RvmonError(f"cannot write {output}: {error.strerror}") from None
