"""Every rule finds its own example, in the words that are kept, and nothing in the mended one."""

import os
from pathlib import Path

import pytest

from rvmon.errors import SpecError
from rvmon.spec import compile_text
from rvmon.spec.pages import example_message, index_page, rule_page
from rvmon.spec.rules.registry import all_rules

ROOT = Path(__file__).parents[3]
GOLDEN = Path(__file__).parent / "golden"
PAGES = ROOT / "docs" / "codes"
RULES = all_rules()


def findings(text):
    """All findings of a specification, errors and warnings."""
    try:
        return compile_text(text)[1]
    except SpecError as error:
        return error.diagnostics


def same_as_file(path, text):
    """Compare with a kept file, or rewrite it on demand."""
    if os.environ.get("RVMON_UPDATE_GOLDEN"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("code", RULES)
def test_example_breaks_its_rule(code):
    """The example is found by its own rule, first of all."""
    found = findings(RULES[code].example)
    assert code in [finding.code for finding in found]
    if code != "RV006":  # so many of another rule that this one speaks
        assert {finding.code for finding in found} == {code}
    assert {finding.severity for finding in found if finding.code == code} == {RULES[code].severity}


@pytest.mark.parametrize("code", RULES)
def test_mended_example_is_in_order(code):
    """The mended example has no findings at all."""
    assert findings(RULES[code].instead) == ()


@pytest.mark.parametrize("code", RULES)
def test_message_is_as_kept(code):
    """The message about the example is the one in the golden file."""
    same_as_file(GOLDEN / f"{code}.txt", example_message(RULES[code]) + "\n")


@pytest.mark.parametrize("code", RULES)
def test_page_is_up_to_date(code):
    """The page in the documentation is the one that the rule makes."""
    same_as_file(PAGES / f"{code}.md", rule_page(RULES[code]))


def test_index_is_up_to_date():
    """The index lists every code."""
    same_as_file(PAGES / "index.md", index_page(RULES))


def test_every_page_has_a_rule():
    """No page or golden file is left of a rule that is gone."""
    assert {path.stem for path in PAGES.glob("RV*.md")} == set(RULES)
    assert {path.stem for path in GOLDEN.glob("RV*.txt")} == set(RULES)


@pytest.mark.parametrize("code", RULES)
def test_message_says_how_to_mend(code):
    """Each first finding has a place and a mend."""
    first = next(finding for finding in findings(RULES[code].example) if finding.code == code)
    assert first.spans or code == "RV006"
    assert first.help
