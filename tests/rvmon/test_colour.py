"""Colours mark severity and place, change no text, and are used on terminals only."""

import io
import re

from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.diagnostics import SEVERITIES, coloured, render_full, wants_colour
from rvmon.language.compile import compile_text


class Terminal(io.StringIO):
    """A stream that claims to be a terminal."""

    def isatty(self):
        return True


def rendered():
    """Two findings with several places, in full."""
    text = "event a\nevent a\nrequirement R\n  upon a or p\n  then within 3 b\n"
    return render_full(findings_of(compile_text, text))


def test_colouring_adds_nothing_but_colours():
    text = rendered()
    shown = coloured(text)
    assert re.sub(r"\x1b\[\d+m", "", shown) == text
    assert shown.count(SEVERITIES["error"]) >= 4  # headings and underlines


@each(
    ("environment", "of_terminal", "of_file"),
    [
        ({}, True, False),
        ({"FORCE_COLOR": "1"}, True, True),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False, False),
        ({"NO_COLOR": "1"}, False, False),
        ({"TERM": "dumb"}, False, False),
    ],
)
def test_terminal_and_environment_decide_about_colours(
    monkeypatch, environment, of_terminal, of_file
):
    for name in ("NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    for name, value in {"TERM": "xterm", **environment}.items():
        monkeypatch.setenv(name, value)
    assert (wants_colour(Terminal()), wants_colour(io.StringIO())) == (of_terminal, of_file)
