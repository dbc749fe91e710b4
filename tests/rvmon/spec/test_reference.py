"""The examples of the language reference are in order, and laid out as the formatter does."""

import re
from pathlib import Path

import pytest

from rvmon.errors import SpecError
from rvmon.spec import compile_text
from rvmon.spec.effort import DEEPEST, LARGEST
from rvmon.spec.findings import MOST
from rvmon.spec.formatter import format_text
from rvmon.spec.rules.goals import MOST_COMBINATIONS
from rvmon.spec.words import FUNCTIONS, ITEM_WORDS

DOCS = Path(__file__).parents[3] / "docs" / "reference"
PAGE = (DOCS / "language.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```rv\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("text", EXAMPLES)
def test_example(text):
    """An example has no errors; that a fragment reads little is no matter."""
    try:
        _, warnings = compile_text(text)
    except SpecError as error:
        pytest.fail(str(error))
    assert {warning.code for warning in warnings} <= {"RV046"}
    assert format_text(format_text(text)) == format_text(text)


def test_reference_is_complete():
    """Every item word, function and limit is named."""
    for word in (*ITEM_WORDS, *FUNCTIONS):
        assert re.search(rf"`[^`]*\b{word}\b", PAGE), word
    for limit in (DEEPEST, LARGEST, MOST, MOST_COMBINATIONS):
        assert f"{limit:,}" in PAGE
