"""Lines and tables on a terminal: control characters are visible, columns are aligned."""

import io
import re

import pytest

from rvmon.report.printer import Printer

ESCAPE = "a\x1b[31m\x9b8m\u202e"
ROWS = [
    ("R1", ("F  ✗", "bold red"), "the hand is held still"),
    (ESCAPE, "P  ✓", "速度 is low"),
]


def printed(width, rows=ROWS, right=()):
    """The lines of a table."""
    file = io.StringIO()
    Printer(file, width).table(["", "verdict", "requirement"], rows, right)
    return file.getvalue().splitlines()


def test_columns_are_aligned_by_what_is_shown():
    blank, *lines, end = printed(80)
    assert blank == end == ""
    assert lines == [
        "                         verdict   requirement",
        " " + "─" * 56,
        " R1                      F  ✗      the hand is held still",
        r" a\x1b[31m\x9b8m\u202e   P  ✓      速度 is low",
    ]


def test_counts_end_below_each_other():
    assert printed(80, [("R1", "5", ""), ("R2", "1995", "")], right=(1,))[3:5] == [
        " R1         5",
        " R2      1995",
    ]


def test_the_widest_of_the_columns_that_are_wrapped_gives_way_first():
    file = io.StringIO()
    rows = [("a name of two lines", "P", "and a longer text beside it"), ("", "F", "short")]
    Printer(file, 40).table(["", "verdict", "why"], rows, wraps=(0, 2))
    assert file.getvalue().splitlines()[3:] == [
        " a name of      P         and a longer",
        " two lines                text beside",
        "                          it",
        "                F         short",
        "",
    ]


def test_a_cell_has_pieces_and_a_table_a_second_head_and_a_foot():
    file = io.StringIO()
    rows = [["R1", [("5", "green"), (" 1", "dim")]]]
    Printer(file, 80).table(["", "P F"], rows, over=["", "runs"], foot=["all", "6"], right=[1])
    assert file.getvalue().splitlines() == [
        *("", "       runs", "        P F", " " + "─" * 10, " R1     5 1", "", " all      6", ""),
    ]


def test_a_row_that_is_cut_is_one_line():
    file = io.StringIO()
    Printer(file, 34).table(
        ["", "requirement"], [("R1", "the hand is held still all day")], is_cut=True
    )
    assert file.getvalue().splitlines()[3:] == [" R1   the hand is held still all…", ""]


@pytest.mark.parametrize("width", [40, 80])
def test_colours_change_no_text(monkeypatch, width):
    monkeypatch.delenv("NO_COLOR", raising=False)
    plain = printed(width)
    monkeypatch.setenv("FORCE_COLOR", "1")
    coloured = printed(width)
    assert "\x1b[1;31mF  ✗\x1b[0m" in "\n".join(coloured)
    assert [re.sub(r"\x1b\[[\d;]+m", "", line).rstrip() for line in coloured] == plain


@pytest.mark.parametrize(("columns", "width"), [("132", 132), ("0", 80)])
def test_it_is_as_wide_as_was_said(monkeypatch, columns, width):
    monkeypatch.setenv("COLUMNS", columns)
    assert Printer(io.StringIO()).width == width


def test_texts_are_shown_and_not_obeyed():
    file = io.StringIO()
    Printer(file).line((ESCAPE, "bold"), ESCAPE)
    assert file.getvalue() == r"a\x1b[31m\x9b8m\u202e" * 2 + "\n"
