"""Templates escape their values: none disables that or leaves an attribute unquoted."""

import re
from importlib import resources

import pytest
from tests.tools.each import each

from rvmon.report.tracks import TrackKind

TEMPLATES = {
    path.name: path.read_text("utf-8")
    for path in (resources.files("rvmon.report") / "templates").iterdir()
}


@each("name", TEMPLATES)
def test_what_a_template_writes_is_escaped(name):
    text = TEMPLATES[name]
    assert not re.search(r"\|\s*safe\b|autoescape", text)
    assert not re.search(r"\w=\{\{", text)


@pytest.mark.parametrize("kind", [one.value for one in TrackKind])
def test_no_other_style_applies_to_a_lane(kind):
    """A lane has the classes `plot` and its kind; no selector starts with the kind alone."""
    assets = resources.files("rvmon.report") / "assets"
    styles = "".join(one.read_text() for one in assets.iterdir() if one.name.endswith(".css"))
    assert f".plot.{kind}" in styles
    assert not re.search(rf"(?:^|[,}}])\s*\.{kind}\b", styles, re.MULTILINE)
