"""What the commands print goes through here: names and cells of others do not steer a terminal.

Texts that have to stay as they are go past it to `sys.stdout`: a specification that is laid out,
code that is generated.
"""

from __future__ import annotations

import codecs
import io
import sys
from collections.abc import Sequence
from shutil import get_terminal_size
from typing import TYPE_CHECKING

from rvmon.diagnostics.shown import shown, shown_json

if TYPE_CHECKING:
    from rvmon.diagnostics.diagnostic import Diagnostic

_SPELLED = str.maketrans(
    dict(zip("✓✗–−─·→▶▼●○◆◇■█▇▁░│├└╱╲×", "+x---.>>v*o*o###_.||`/\\x", strict=True))
    | {"…": "...", "≤": "<=", "≥": ">=", "≠": "!=", "∞": "inf"}
)


def say(text: str = "", *, end: str = "\n", flush: bool = False) -> None:
    """Print a text for people."""
    print(shown(text), end=end, flush=flush)


def say_json(text: str) -> None:
    """Print JSON text."""
    print(shown_json(text))


def spell() -> None:
    """Let signs that the encoding of the output lacks be spelled with those that it has."""

    def spelled(error: UnicodeError) -> tuple[str, int]:
        assert isinstance(error, UnicodeEncodeError)  # noqa: S101 - what is written is text
        signs = error.object[error.start : error.end].translate(_SPELLED)
        return signs.encode("ascii", "replace").decode(), error.end

    if isinstance(sys.stdout, io.TextIOWrapper):
        codecs.register_error("rvmon", spelled)
        sys.stdout.reconfigure(errors="rvmon")


def rendered(findings: Sequence[Diagnostic]) -> str:
    """Findings in full, as wide as the terminal is."""
    from rvmon.diagnostics.render import WIDEST, render_full

    return render_full(findings, get_terminal_size((WIDEST, 0)).columns)


def warn(text: str) -> None:
    """Print to standard error what a person should know."""
    print(shown(text), file=sys.stderr)
