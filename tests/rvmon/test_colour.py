"""Colours say severity and place, change no text, and are asked for by terminals only."""

import io
import re

from tests.tools.findings import findings_of

from rvmon.diagnostics import SEVERITIES, coloured, render_full, wants_colour
from rvmon.language.compile import compile_text


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def rendered():
    """Two findings with several places, in full."""
    text = "event a\nevent a\nrequirement R\n  upon a or p\n  then within 3 b\n"
    return render_full(findings_of(compile_text, text))


def test_only_colours_are_added():
    text = rendered()
    shown = coloured(text)
    assert re.sub(r"\x1b\[\d+m", "", shown) == text
    assert shown.count(SEVERITIES["error"]) >= 4  # headings and underlines


def test_who_gets_colours(monkeypatch):
    for name in ("NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert wants_colour(Terminal())
    assert not wants_colour(io.StringIO())
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert wants_colour(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not wants_colour(io.StringIO())
    monkeypatch.delenv("FORCE_COLOR")
    assert not wants_colour(Terminal())
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not wants_colour(Terminal())
