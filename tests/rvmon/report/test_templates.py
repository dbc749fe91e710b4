"""Templates escape what they are given: none switches that off, or leaves an attribute bare."""

import re
from importlib import resources

import pytest

TEMPLATES = {
    path.name: path.read_text("utf-8")
    for path in (resources.files("rvmon.report") / "templates").iterdir()
}


@pytest.mark.parametrize("name", TEMPLATES)
def test_what_a_template_writes_is_escaped(name):
    """No `safe`, no block without escaping; every attribute that is filled in is quoted."""
    text = TEMPLATES[name]
    assert not re.search(r"\|\s*safe\b|autoescape", text)
    assert not re.search(r"\w=\{\{", text)
