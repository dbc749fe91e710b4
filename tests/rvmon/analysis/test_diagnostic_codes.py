"""Every rule reports the example of its page in the page's words, and nothing in the mended one."""

import os
from pathlib import Path

import pytest
from tests.tools.code_pages import page
from tests.tools.each import each

from rvmon.analysis.diagnostic_codes import code_list, every_page, every_rule, page_of
from rvmon.analysis.shortest_examples import analyse
from rvmon.diagnostics import render_full
from rvmon.errors import ModelError, SpecError, UnknownNameError
from rvmon.language.compile import compile_text
from rvmon.models.conform import conform
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.verify import verify
from rvmon.monitor.compiled_spec import compile_spec

RULES = every_rule()
PAGES = Path(__file__).parents[3] / "src" / "rvmon" / "analysis" / "pages"


_MOST = 5
"""Of more findings the first and the last are shown."""


def findings_about(code, text):
    """The findings in a text of the pass that a code belongs to: check, analysis, or model."""
    if code.startswith("TA"):
        return _findings_in_model(text)
    try:
        checked, found = compile_text(text, name="demo.rv")
    except SpecError as error:
        return tuple(error.diagnostics)
    if not code.startswith("RV07"):
        return tuple(found)
    return analyse(compile_spec(checked), timelines=0).findings


def _findings_in_model(text):
    """By verifying its queries; without queries, by checking an empty recording against it."""
    try:
        network = loads_network(text, name="demo.ta") if text else load_network("none/demo.ta")
        for query in network.queries:
            verify(network, query)
        if not network.queries:
            conform(network, (), observed=frozenset(), end=0, tolerance=0)
    except ModelError as error:
        return error.diagnostics
    return network.warnings


def message_about(found):
    """The message about an example; of a long list the start and the end."""
    if len(found) <= _MOST:
        return render_full(found)
    return f"{render_full(found[:1])}\n\n…\n\n{render_full(found[-1:])}"


@each("code", RULES)
def test_example_breaks_its_rule_and_the_fixed_one_none(code):
    shown, rule = page(code), RULES[code]
    found = findings_about(code, shown.example)
    own = [finding for finding in found if finding.code == code]
    # RV006 is reported if there are too many findings of another rule.
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
