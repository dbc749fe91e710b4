"""Any text gives a specification or findings, never an internal error."""

import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tools.code_pages import page

from rvmon.analysis.diagnostic_codes import every_page
from rvmon.diagnostics import render_concise, render_full, render_json
from rvmon.errors import SpecError
from rvmon.language.compile import compile_text
from rvmon.language.formatter import format_text

ROOT = Path(__file__).parents[3]
RULES = [page(code) for code in sorted(every_page()) if code.startswith("RV")]
SEEDS = [
    *(path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("specs/*.rv"))),
    *(path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("src/rvmon/language/*/*.rv"))),
    *(page.example for page in RULES if len(page.example) < 500),
    *(page.instead for page in RULES),
]
WORD = re.compile(r"\w+|[^\w\s]+|\s+")
WORDS = [
    *sorted({word for seed in SEEDS for word in WORD.findall(seed)}),
    *("->", "<->", "E<>", "A[]", "[0, 3 s)", "inf", "`x y`", "age(", "held(", "-->"),
    *("1e999", "1e9999999999", "\x00", "é", "\u201c", "\\", "(" * 50, "not " * 60, "a + " * 80),
]


def answer(text):
    """Compile any text and render the result."""
    try:
        checked, findings = compile_text(text)
        assert checked is not None
    except SpecError as error:
        findings = error.diagnostics
        assert findings
    assert render_full(findings) or not findings
    render_concise(findings)
    render_json(findings)
    for finding in findings:
        for label in finding.spans:
            span = label.span
            assert 0 <= span.start <= span.end <= len(span.source.text)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=60))
def test_any_words(words):
    answer("".join(words))


@pytest.mark.slow
def test_mutated_specifications():
    for seed in range(100):
        rng = random.Random(seed)
        words = WORD.findall(rng.choice(SEEDS))
        for _ in range(rng.randint(1, 6)):
            place = rng.randrange(len(words))
            words[place] = rng.choice(("", rng.choice(WORDS), words[place] * 2, rng.choice(words)))
        text = "".join(words)
        answer(text)
        try:
            laid_out = format_text(text)
        except SpecError:
            continue
        assert format_text(laid_out) == laid_out


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        "requirement R " + "(" * 5000,
        "requirement R always " + "(" * 5000 + "a" + ")" * 5000,
        "requirement R " + "not " * 5000 + "a",
        "requirement R " + "a -> " * 5000 + "a",
        "signal a : bool\nrequirement R always (" + " or ".join(["a"] * 2000) + ")",
        "property P: " + "AG " * 5000 + "a",
        "const T = " + "9" * 5000,
        "const T = 5 " + "m*" * 3000 + "m",
        "signal a : real [" + "m^99*" * 1000 + "m]",
        "time\n" * 3000,
        '"' * 5000,
        "\n" * 5000,
    ],
    ids=lambda text: text[:20],
)
def test_nesting_and_repetition(text):
    answer(text)
