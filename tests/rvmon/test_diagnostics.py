"""Findings as full text, as single lines and as JSON."""

import json

from tests.tools.each import each

from rvmon.diagnostics import (
    Diagnostic,
    Label,
    Severity,
    Source,
    Span,
    render_concise,
    render_full,
    render_json,
    snippet,
)

SOURCE = Source("specs/demo.rv", "spec demo\nevent released\n  then\twithin 3 s relased\n")
PLACE = SOURCE.text.index("relased")
FINDING = Diagnostic(
    "RV012",
    "unknown-signal",
    Severity.ERROR,
    "no signal or event named `relased`",
    (Label(Span(SOURCE, PLACE, PLACE + 7)), Label(Span(SOURCE, 16, 24), "declared here")),
    "did you mean `released`?",
)
BARE = Diagnostic("RV006", "too-many-findings", Severity.WARNING, "so much")


def test_a_concise_finding_is_one_line_with_its_help():
    assert render_concise([FINDING, BARE]).splitlines() == [
        "specs/demo.rv:3:19: error[RV012 unknown-signal]: no signal or event named `relased`"
        " (help: did you mean `released`?)",
        "warning[RV006 too-many-findings]: so much",
    ]


def test_json_has_a_line_for_each_finding():
    """A program can match the first place of each finding line by line."""
    text = render_json([FINDING, BARE])
    first, second = json.loads(text)
    assert (first["code"], first["severity"], second["spans"]) == ("RV012", "error", [])
    assert first["spans"][0]["start"] == {"line": 3, "column": 19, "offset": PLACE}
    assert first["spans"][0]["end"]["column"] == 26
    assert first["spans"][1]["text"] == "declared here"
    line, other = text.splitlines()[1:-1]
    assert line.startswith('{"file": "specs/demo.rv", "line": 3, "column": 19, "severity": "error"')
    assert other.startswith('{"file": "", "line": 0')
    assert json.loads(render_json([])) == []


def test_escapes_do_not_reach_the_terminal():
    place = (Label(Span(Source("a\x1b[2J.rv", "\x1b[31m"), 0, 5)),)
    found = Diagnostic("RV001", "syntax", Severity.ERROR, "found `\x1b`", place)
    for text in (render_full([found]), render_concise([found]), render_json([found])):
        assert "\x1b" not in text


def lines(text, start, end):
    """The line and its underline."""
    shown = snippet(Span(Source("x", text), start, end)).splitlines()
    return shown[2], shown[3]


@each(
    ("text", "start", "end", "line", "underline"),
    [
        # Places at the edges of lines and of the text.
        ("ab", 2, 2, " 1 | ab", "   |   ^"),
        ("", 0, 0, " 1 |", "   | ^"),
        ("ab\ncd\n", 1, 5, " 1 | ab", "   |  ^"),
        ("ab\n", 3, 3, " 2 |", "   | ^"),
        # Wide and unprintable characters.
        ("数 x", 2, 3, " 1 | 数 x", "   |    ^"),
        ("\x00\x1b x", 3, 4, r" 1 | \x00\x1b x", "   |          ^"),
        ("a\r\nb", 0, 1, " 1 | a", "   | ^"),
    ],
)
def test_a_place_is_underlined(text, start, end, line, underline):
    assert lines(text, start, end) == (line, underline)


def test_long_lines_are_cut_around_the_place():
    line, underline = lines("x" * 5000 + "HERE" + "y" * 5000, 5000, 5004)
    assert len(line) <= 110
    assert line.startswith(" 1 | …")
    assert line.endswith("…")
    assert line[underline.index("^") :][:4] == "HERE"
    assert underline.count("^") == 4
