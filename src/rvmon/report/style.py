"""The look of verdicts in the terminal and on pages: always a letter, then sign and colour."""

from __future__ import annotations

from dataclasses import dataclass

from rich.text import Text

from rvmon.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class Mark:
    """The look of one verdict.

    Attributes:
        word: for sentences ("R2 failed").
        sign: a shape that distinguishes it without colour.
        terminal: a style of rich.
        light: CSS colour on a light page.
        dark: CSS colour on a dark page.
    """

    word: str
    sign: str
    terminal: str
    light: str
    dark: str


MARKS = {
    Verdict.PASS: Mark("passed", "✓", "green", "#1a7f4b", "#4cc38a"),
    Verdict.FAIL: Mark("failed", "✗", "bold red", "#c4302b", "#ff7b72"),
    Verdict.NOT_TRIGGERED: Mark("was not triggered", "–", "bright_black", "#6b7280", "#8b949e"),
    Verdict.INCONCLUSIVE: Mark("is inconclusive", "?", "yellow", "#9a6700", "#e3b341"),
}
"""The look of each verdict; the contrast with the page is at least 4.5 to 1."""


def verdict_colours() -> str:
    """The colours as CSS variables named by the verdicts' letters, for light and dark pages."""
    light = "".join(f"--{verdict.value}:{mark.light};" for verdict, mark in MARKS.items())
    dark = "".join(f"--{verdict.value}:{mark.dark};" for verdict, mark in MARKS.items())
    return f":root{{{light}}}@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}"


def verdict_text(verdict: Verdict) -> Text:
    """A verdict as styled text for the terminal: its letter, then its sign."""
    mark = MARKS[verdict]
    return Text(f"{verdict.value:<2} {mark.sign}", style=mark.terminal)
