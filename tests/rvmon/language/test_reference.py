"""The examples of the language reference compile and are formatted."""

import re
from pathlib import Path

import pytest
from tests.tools.each import each

from rvmon.errors import SpecError
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.compile import compile_text
from rvmon.language.formatter import format_text
from rvmon.language.rules import MOST
from rvmon.language.rules.requirements import MOST_COMBINATIONS
from rvmon.language.rules.syntax import DEEPEST, LARGEST
from rvmon.language.syntax.keywords import CLAUSE_WORDS, INFIX_WORDS, ITEM_WORDS, RESERVED
from rvmon.language.syntax.parse import grammar
from rvmon.units import unit_table

DOCS = Path(__file__).parents[3] / "docs" / "reference"
PAGE = (DOCS / "language.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```rv\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("text", EXAMPLES)
def test_example(text):
    try:
        _, warnings = compile_text(text)
    except SpecError as error:
        pytest.fail(str(error))
    assert {warning.code for warning in warnings} <= {"RV046"}
    assert format_text(format_text(text)) == format_text(text)


OPEN = ("NAME", "CALL", "NUMBER", "UNIT", "STRING", *grammar().ignore_tokens)
"""Terminals that stand for many words."""


def grammar_words():
    """All words of the language: those of the grammar's terminals, and the reserved words."""
    yield from RESERVED | INFIX_WORDS | CLAUSE_WORDS | FUNCTIONS.keys()
    for terminal in grammar().terminals:
        if terminal.name not in OPEN:
            pattern = terminal.pattern.value.replace(r"\s", " ").replace(r"\w", " ")
            yield from re.findall(r"[a-z]{2,}", pattern)


def test_every_word_of_the_grammar_is_named():
    prose = re.sub(r"```.*?```|``.*?``", "", PAGE, flags=re.DOTALL)
    quoted = "\n".join([*re.findall(r"`([^`]+)`", prose), *EXAMPLES])
    assert {*grammar_words()} <= {*re.findall(r"\w+(?= |\b)", quoted)}


@each("sign", ["<->", "->", "-->", "&&", "||", "!", "A[]", "E<>", "inf", "∞"])
def test_every_sign_is_named(sign):
    assert sign in PAGE.replace("\\|", "|")


def test_every_unit_is_named():
    named = set(re.findall(r"`([^`]+)`", PAGE[PAGE.index("### Units") :]))
    prefixed = {
        unit for unit in unit_table() if unit[0] in "nuµmcdkMG" and unit[1:] in unit_table()
    }
    assert unit_table().keys() - prefixed - named == {"A", "W"} - named


def test_reference_is_complete():
    for word in (*ITEM_WORDS, *FUNCTIONS):
        assert re.search(rf"`[^`]*\b{word}\b", PAGE), word
    for limit in (DEEPEST, LARGEST, MOST, MOST_COMBINATIONS):
        assert f"{limit:,}" in PAGE
