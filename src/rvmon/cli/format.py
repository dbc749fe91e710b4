"""`rvmon format`: lay specifications out in the canonical form."""

from __future__ import annotations

import argparse
import sys

from rvmon.cli.output import say, warn
from rvmon.errors import SpecError
from rvmon.files import write_whole
from rvmon.language.formatter import format_text
from rvmon.texts import text_of_file, text_of_input


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
