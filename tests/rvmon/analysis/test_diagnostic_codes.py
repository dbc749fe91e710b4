"""Every rule finds its own example, in the words of its page, and nothing in the fixed one."""

import os
from pathlib import Path

import pytest
from tests.tools.code_pages import findings_about, message_about, page

from rvmon.analysis.diagnostic_codes import code_list, every_page, every_rule, page_of
from rvmon.errors import UnknownNameError

RULES = every_rule()
PAGES = Path(__file__).parents[3] / "src" / "rvmon" / "analysis" / "pages"


@pytest.mark.parametrize("code", RULES)
def test_example_breaks_its_rule_and_the_fixed_one_none(code):
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
    assert set(every_page()) == set(RULES)


def test_codes_in_words_and_all():
    assert page_of("Unknown-Signal") == page_of("rv012") == page_of("RV012")
    assert page_of("double-name") == page_of("RV011")
    codes = [line.split()[0] for line in code_list().splitlines()]
    assert codes == list(RULES)


def test_codes_of_models_have_a_page(says):
    for wanted in ("ta008", "diagonal-constraint"):
        assert says(0, "explain", wanted).out == page_of("TA008")
    assert "TA023  no-unit" in says(2, "explain", "TA099").err


def test_unknown_code():
    with pytest.raises(UnknownNameError) as caught:
        page_of("RV999")
    assert "`rvmon explain codes` lists all" in str(caught.value)
    assert "  RV074  implied\n" in str(caught.value)
    with pytest.raises(UnknownNameError, match="RV046  never-read"):
        page_of("never-raed")
