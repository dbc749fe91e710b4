"""`rvmon format`: lay specifications out in the canonical form."""

from __future__ import annotations

import argparse
import sys

from rvmon.cli.output import say, warn
from rvmon.errors import SpecError
from rvmon.files import write_whole
from rvmon.language.formatter import format_text
from rvmon.texts import text_of_file, text_of_input


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "format",
        description="Rewrite specifications in the canonical layout; meaning and comments are "
        "kept. With - as SPEC, standard input is formatted to standard output.",
        epilog="example: rvmon format --check specs/*.rv",
    )
    parser.add_argument("specs", metavar="SPEC", nargs="+", help=".rv files")
    parser.add_argument(
        "--check", action="store_true", help="do not write; exit with 1 if a file would change"
    )


def run(arguments: argparse.Namespace) -> int:
    """Lay out, and return the exit code."""
    changed = wrong = 0
    for name in arguments.specs:
        try:
            text = text_of_input() if name == "-" else text_of_file(name)
            laid_out = format_text(text, name=name)
            if name != "-" and laid_out != text and not arguments.check:
                write_whole(name, laid_out)
        except SpecError as error:
            warn(str(error))
            wrong += 1
            continue
        except (OSError, UnicodeDecodeError) as error:
            reason = "not UTF-8 text" if isinstance(error, ValueError) else error.strerror
            warn(f"error: {name}: {reason}")
            wrong += 1
            continue
        if name == "-" and not arguments.check:
            sys.stdout.write(laid_out)
        elif laid_out != text:
            say(f"{'would change' if arguments.check else 'changed'}: {name}")
        changed += laid_out != text
    if wrong:
        return 2
    return int(arguments.check and changed > 0)
