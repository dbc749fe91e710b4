"""Every rule finds its own example, in the words that are kept, and nothing in the fixed one."""

import os
from pathlib import Path

import pytest

from rvmon.cli import main
from rvmon.errors import UnknownNameError
from rvmon.explain.codes import code_list, every_rule, findings_about, page_of
from rvmon.spec.rules.pages import index_page, message_about

ROOT = Path(__file__).parents[3]
GOLDEN = Path(__file__).parent / "golden"
PAGES = ROOT / "docs" / "codes"
RULES = every_rule()


def found_in_example(code):
    """What is found in the example of a code."""
    return findings_about(RULES[code], RULES[code].example)


def same_as_file(path, text):
    """Compare with a kept file, or rewrite it on demand."""
    if os.environ.get("RVMON_UPDATE_GOLDEN"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("code", RULES)
def test_example_breaks_its_rule(code):
    """The example is found by its own rule, first of all."""
    found = found_in_example(code)
    assert code in [finding.code for finding in found]
    if code != "RV006":  # so many of another rule that this one speaks
        assert {finding.code for finding in found} == {code}
    assert {finding.severity for finding in found if finding.code == code} == {RULES[code].severity}


@pytest.mark.parametrize("code", RULES)
def test_fixed_example_is_in_order(code):
    """The fixed example has no findings at all."""
    assert findings_about(RULES[code], RULES[code].instead) == ()


@pytest.mark.parametrize("code", RULES)
def test_message_is_as_kept(code):
    """The message about the example is the one in the golden file."""
    same_as_file(
        GOLDEN / f"{code}.txt",
        message_about(found_in_example(code)) + "\n",
    )


@pytest.mark.parametrize("code", RULES)
def test_page_is_up_to_date(code):
    """The page in the documentation is the one that the rule makes."""
    same_as_file(PAGES / f"{code}.md", page_of(code))


def test_index_is_up_to_date():
    """The index lists every code."""
    same_as_file(PAGES / "index.md", index_page(RULES))


def test_every_page_has_a_rule():
    """No page or golden file is left of a rule that is gone."""
    assert {path.stem for path in PAGES.glob("[RT]*.md")} == set(RULES)
    assert {path.stem for path in GOLDEN.glob("*.txt")} == set(RULES)


@pytest.mark.parametrize("code", [code for code in RULES if code.startswith("RV")])
def test_message_says_how_to_fix(code):
    """Each first finding in a specification has a place and a fix."""
    first = next(finding for finding in found_in_example(code) if finding.code == code)
    assert first.spans or code == "RV006"
    assert first.help


def test_codes_in_words_and_all():
    """A page is found by its code in words too, in any case; all codes are listed."""
    assert page_of("Unknown-Signal") == page_of("rv012") == page_of("RV012")
    assert page_of("double-name") == page_of("RV011")
    codes = [line.split()[0] for line in code_list().splitlines()]
    assert codes == list(RULES)


def test_codes_of_models_have_a_page(capsys):
    """Each by its code and in words, also from the command line; of others the nearest is named."""
    for wanted in ("ta008", "diagonal-constraint"):
        assert main(["explain", wanted]) == 0
        assert capsys.readouterr().out == page_of("TA008")
    assert main(["explain", "TA099"]) == 2
    assert "TA023  no-unit" in capsys.readouterr().err


def test_unknown_code():
    """Of a code that does not exist those most alike are named, and where all are."""
    with pytest.raises(UnknownNameError) as caught:
        page_of("RV999")
    assert "`rvmon explain codes` lists all" in str(caught.value)
    assert "  RV074  implied\n" in str(caught.value)
    with pytest.raises(UnknownNameError, match="RV046  never-read"):
        page_of("never-raed")
