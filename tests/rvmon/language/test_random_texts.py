"""Random texts by the grammar: they can be read, are varied, and layout keeps what they say."""

import random

import pytest
from tests.rvmon.language.generate_text import HEAD, random_text, syntax_of

from rvmon.language.formatter import format_text, pieces_of
from rvmon.language.syntax.parse import grammar


@pytest.mark.slow
def test_most_texts_can_be_read_all_words_occur_and_layout_keeps_what_they_say():
    """What the grammar makes the parser reads, but for what has to be bracketed."""
    missing = {terminal.name for terminal in grammar().terminals} - {*grammar().ignore_tokens}
    made, read, before = 0, 0, ""
    while missing or made < 200:
        text = random_text(random.Random(f"1/{made}")).removeprefix(HEAD)
        made += 1
        assert made < 4_000, missing
        if syntax_of(text) is None:
            continue
        read += 1
        missing -= {piece.kind for piece in pieces_of(text)[0]}
        if read < 50:
            whole = HEAD + before + text
            once = format_text(whole)
            assert syntax_of(once) == syntax_of(whole)
            assert format_text(once) == once
            assert once.count("# note") == whole.count("# note")
        before = text
    assert read > made / 2


def test_syntax_has_no_places():
    """Two texts that differ in layout have one syntax; a bracket or another word makes two."""
    first = syntax_of(HEAD + "requirement R always (p -> F q)")
    assert first is not None
    assert first == syntax_of(HEAD + "requirement R\n  always (p -> # note\n  eventually q)\n")
    assert first != syntax_of(HEAD + "requirement R always (p -> F (q))")
    assert syntax_of("requirement R always (") is None
