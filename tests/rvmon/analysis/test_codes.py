"""Every rule finds its own example, in the words of its page, and nothing in the fixed one."""

import os
from pathlib import Path

import pytest
from tests.tools.code_pages import findings_about, message_about, page

from rvmon.analysis.codes import code_list, every_page, every_rule, page_of
from rvmon.cli import main
from rvmon.errors import UnknownNameError

RULES = every_rule()
PAGES = Path(__file__).parents[3] / "src" / "rvmon" / "analysis" / "pages"


@pytest.mark.parametrize("code", RULES)
def test_example_breaks_its_rule_and_the_fixed_one_none(code):
    """First of all its own, in the words of its page, with place and fix; the fixed one is well."""
    shown, rule = page(code), RULES[code]
    found = findings_about(code, shown.example)
    own = [finding for finding in found if finding.code == code]
    # RV006 speaks if there are so many of another rule.
    assert {finding.code for finding in found} == {code} or (code == "RV006" and own)
    assert {finding.severity for finding in own} == {rule.severity}
    if code.startswith("RV"):
        assert own[0].spans or code == "RV006"
        assert own[0].help
    message = message_about(found)
    if os.environ.get("RVMON_UPDATE_GOLDEN"):
        file = PAGES / f"{code[:4]}.md"
        fences = (f"```text\n{text}\n```" for text in (shown.message, message))
        written = shown.text.replace(*fences)
        file.write_text(file.read_text("utf-8").replace(shown.text, written), "utf-8")
    assert shown.message == message
    assert (shown.code, shown.name, shown.severity) == (code, rule.name, str(rule.severity))
    assert findings_about(code, shown.instead) == ()


def test_every_page_has_a_rule():
    """No page is left of a rule that is gone."""
    assert set(every_page()) == set(RULES)


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
