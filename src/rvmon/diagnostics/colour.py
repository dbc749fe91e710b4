"""Rendered findings in the colours of a terminal."""

from __future__ import annotations

import os
import re
from typing import TextIO

RESET, BOLD, BLUE, CYAN = "\x1b[0m", "\x1b[1m", "\x1b[34m", "\x1b[36m"
SEVERITIES = {"error": "\x1b[31m", "warning": "\x1b[33m"}

_HEADING = re.compile(r"(error|warning)(\[[^\]]*\]): (.*)")
_ARROW = re.compile(r"( *(?:-->|:::) )(.*)")
_UNDERLINE = re.compile(r"( +\| +)(\^+|-+)(.*)")


def wants_colour(stream: TextIO) -> bool:
    """Whether a stream is a terminal and nobody asked for plain text (`NO_COLOR`)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def coloured(text: str) -> str:
    r"""Findings as `render_full` writes them, with severity, places and help in colour.

    >>> coloured("help: did you mean `a`?")
    '\x1b[36mhelp:\x1b[0m did you mean `a`?'
    """
    lines = []
    mark = ""
    for line in text.split("\n"):
        if found := _HEADING.fullmatch(line):
            mark = SEVERITIES[found[1]]
            line = f"{BOLD}{mark}{found[1]}{found[2]}{RESET}{BOLD}: {found[3]}{RESET}"
        elif found := _ARROW.fullmatch(line):
            line = f"{BLUE}{found[1]}{RESET}{found[2]}"
        elif found := _UNDERLINE.fullmatch(line):
            own = mark if found[2][0] == "^" else BLUE
            line = f"{BLUE}{found[1]}{RESET}{own}{found[2]}{found[3]}{RESET}"
        elif line.startswith("help:"):
            line = f"{CYAN}help:{RESET}{line.removeprefix('help:')}"
        lines.append(line)
    return "\n".join(lines)
