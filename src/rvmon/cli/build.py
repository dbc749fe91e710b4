"""`rvmon build`: a specification as a program that checks recordings by itself."""

from __future__ import annotations

import argparse
import os

from rvmon.cli.options import add_const, add_only, asked_ids, constants_of
from rvmon.cli.progress import busy
from rvmon.errors import RvmonError
from rvmon.writing import write_whole


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "build",
        help="a specification as a program that checks recordings",
        description="Compile a specification to a program (by a C compiler: $CC, cc, gcc or "
        "clang). It reads a recording (.csv, .jsonl, .bin, or - for JSON lines on standard input) "
        "and prints the verdicts as `rvmon run --format json` does, without reasons.",
        epilog="example: rvmon build examples/base.rv -o judge && ./judge examples/base.csv",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument("-o", "--output", metavar="BINARY", required=True, help="the program")
    parser.add_argument(
        "--robustness",
        action="store_true",
        help="print the robustness of each attempt as well, as `rvmon run --robustness` does",
    )
    add_only(parser)
    add_const(parser)


def run(arguments: argparse.Namespace) -> int:
    """Generate, compile and copy, and return the exit code."""
    from rvmon.codegen.c_build import built
    from rvmon.codegen.c_program import program_build
    from rvmon.loading import load

    spec = load(arguments.spec, const=constants_of(arguments.const))
    measured = arguments.robustness
    plan = spec.plan(only=asked_ids(arguments, spec), robustness=measured)
    with busy("compiling"):
        path = built(program_build(plan, measured=measured))
    try:
        write_whole(arguments.output, path.read_bytes())
        if os.path.isfile(arguments.output):  # whoever may read it may run it
            mode = os.stat(arguments.output).st_mode
            os.chmod(arguments.output, mode | (mode & 0o444) >> 2)
    except OSError as error:
        raise RvmonError(f"cannot write {arguments.output}: {error.strerror}") from None
    return 0
