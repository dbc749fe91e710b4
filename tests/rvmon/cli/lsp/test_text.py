"""Positions as editors count them, and edits at such positions."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol.types import (
    Position,
    Range,
    TextDocumentContentChangePartial,
    TextDocumentContentChangeWholeDocument,
)

from rvmon.cli.lsp.document import Text

UNITS = {
    "utf-8": lambda text: len(text.encode()),
    "utf-16": lambda text: len(text.encode("utf-16-le")) // 2,
    "utf-32": len,
}
TEXTS = st.text(st.sampled_from("ab😋é漢\u2028\x0c\x85\t")) | st.just("\r")
LINES = st.lists(st.tuples(TEXTS, st.sampled_from(["\n", "\r\n", "\r"])), max_size=4)


def position(text, offset, encoding):
    """Line and column as the protocol defines them."""
    lines = re.split(r"\r\n|\r|\n", text[:offset])
    return Position(len(lines) - 1, UNITS[encoding](lines[-1]))


@pytest.mark.slow
@given(LINES, TEXTS, TEXTS, st.sampled_from(sorted(UNITS)), st.data())
def test_ranges_and_edits_agree_with_the_definition_of_the_protocol(
    lines, last, new, encoding, data
):
    raw = "".join(map("".join, lines)) + last
    places = [n for n in range(len(raw) + 1) if raw[max(n - 1, 0) : n + 1] != "\r\n"]
    start, end = sorted(data.draw(st.tuples(st.sampled_from(places), st.sampled_from(places))))
    text = Text(raw, encoding)
    where = Range(position(raw, start, encoding), position(raw, end, encoding))
    assert text.range(start, end) == where
    edited = text.changed(TextDocumentContentChangePartial(where, new))
    assert edited.raw == raw[:start] + new + raw[end:]
    assert len(edited.code) == len(edited.raw)
    assert edited.changed(TextDocumentContentChangeWholeDocument(raw)).raw == raw


def test_positions_out_of_range_are_the_end_of_line_or_text():
    text = Text("a\r\nb😋\nc")
    assert [text.offset(Position(0, 9)), text.offset(Position(1, 9))] == [1, 5]
    assert text.offset(Position(7, 0)) == len(text.raw)
    assert text.offset(Position(1, 2)) == 4, "a position within a character is before it"
