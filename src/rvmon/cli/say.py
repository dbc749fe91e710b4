"""What the commands print goes through here: names and cells of others do not steer a terminal.

Texts that have to stay as they are go past it to `sys.stdout`: a specification that is laid out,
code that is generated.
"""

from __future__ import annotations

import sys

from rvmon.diagnostics.shown import shown, shown_json


def say(text: str = "", *, end: str = "\n", flush: bool = False) -> None:
    """Print a text for people."""
    print(shown(text), end=end, flush=flush)


def say_json(text: str) -> None:
    """Print JSON text."""
    print(shown_json(text))


def warn(text: str) -> None:
    """Print to standard error what a person should know."""
    print(shown(text), file=sys.stderr)
