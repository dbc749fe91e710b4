"""Output fits the width and the encoding of the terminal."""

import io
import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from rvmon.cli import main

BASE = Path(__file__).parents[3] / "examples" / "base"
WRONG = """signal speed : real [m/s]
event a_rather_long_name_of_an_event
requirement R
  upon a_rather_long_name_of_an_event then within 2 s for 1 s spede <= 1 m/s or speed > 3 m/s
"""


def underlined(text):
    """The text above each line of carets."""
    lines = text.splitlines()
    for above, line in pairwise(lines):
        if set(line.strip(" |")) == {"^"}:
            yield above[line.index("^") : line.rindex("^") + 1]


@pytest.mark.parametrize("columns", ["40", "80", "200"])
def test_carets_underline_the_right_part_at_any_width(put, monkeypatch, says, columns):
    monkeypatch.setenv("COLUMNS", columns)
    shown = says(1, "run", f"{BASE}.rv", f"{BASE}.csv").out
    assert next(underlined(shown)) == "speed <= 300 mm/s"
    put("wrong.rv", WRONG)
    for words in (["check", "wrong.rv"], ["run", "wrong.rv", f"{BASE}.csv"]):
        told = says(2, *words).err
        assert list(underlined(told))[-1] == "spede"
        shown += told
    lines = [line for line in shown.splitlines() if re.match(r" *\d+ \| ", line)]
    assert max(map(len, lines)) <= int(columns)


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_signs_missing_from_an_encoding_are_replaced(monkeypatch, encoding):
    """Never by a question mark, which is the sign of an I; lines keep their length."""
    texts = []
    for encoded in ("utf-8", encoding):
        out = io.TextIOWrapper(io.BytesIO(), encoding=encoded)
        monkeypatch.setattr(sys, "stdout", out)
        assert main(["why", f"{BASE}.rv", f"{BASE}.csv", "B2#2"]) == 0
        texts.append(out.buffer.getvalue().decode(encoded))
    original, replaced = texts
    assert replaced.startswith("B2#2  F  x\n")
    assert replaced.count("?") == original.count("?")
    assert list(map(len, replaced.splitlines())) == list(map(len, original.splitlines()))
