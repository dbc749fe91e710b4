"""What the documentation makes of the code is whole: grammar, commands, patterns, pictures."""

import re
import sys
from importlib import import_module

import pytest
from tests.docs.pages import PAGES, ROOT
from tests.tools.each import each

from rvmon.cli import COMMANDS

PICTURES = [
    (page, text)
    for page in PAGES
    for text in re.findall(
        r"```\{timeline\}\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL
    )
]


@pytest.fixture
def made(monkeypatch):
    """Import a module of the site's own extensions."""
    monkeypatch.setattr(sys, "path", [str(ROOT / "docs" / "extensions"), *sys.path])
    return import_module


@pytest.mark.slow
@pytest.mark.parametrize("name", ["grammar", "model_grammar"])
def test_every_name_of_the_grammar_has_a_production(made, name):
    """None is left of the names that Lark needs, and each can be looked up."""
    text = getattr(made("specification_language"), name)()
    productions = re.findall(r"^(\w+) ::=", text, re.MULTILINE)
    rights = re.sub(r"'[^'\n]*'|/[^/\n]*/|<[\w-]+>|^\w+ ::=|```\w*", "", text, flags=re.MULTILINE)
    assert set(re.findall(r"[A-Za-z_]+", rights)) <= set(productions)
    assert len(productions) == len(set(productions)) > 50
    assert "@" not in text


def test_operators_of_the_grammar_are_spelled_out(made):
    """What the parser fills in from its tables stands there."""
    text = made("specification_language").grammar()
    assert re.search(r"^INFIX ::= .*'until'", text, re.MULTILINE)
    assert "requirement ::= 'requirement' NAME STRING? body clause*" in text


def test_every_command_is_described(made):
    text = made("command_line").commands("rvmon")
    titles = re.findall(r"^## rvmon (\w+)", text, re.MULTILINE)
    assert set(titles) == set(COMMANDS)
    assert "`--robustness`\n: " in text


def test_every_pattern_is_described(made):
    """A pattern in another form than the page is made of would be an error."""
    assert made("pattern_library").patterns().count("\n### ") == 17


@each(("page", "text"), PICTURES)
def test_a_picture_is_drawn(made, page, text):
    drawn = made("timeline").timeline(text.rstrip("\n"))
    names = text.partition("---\n")[2].partition("\n")[0].split(",")[1:]
    requirements = re.findall(r"^requirement (\w+)", text, re.MULTILINE)
    assert re.findall(r'"end">(\w+)<', drawn) == [*names, *requirements]
