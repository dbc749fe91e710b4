"""The editor grammar colours specifications by the words of the language."""

import json
import re
from pathlib import Path

import pytest

from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.syntax.keywords import INFIX_WORDS, RESERVED
from tests.tools.findings import findings_of

ROOT = Path(__file__).parents[1]
VSCODE = ROOT / "editors" / "vscode"
GRAMMAR = json.loads((VSCODE / "syntaxes" / "rv.tmLanguage.json").read_text(encoding="utf-8"))
SPECS = sorted([*ROOT.glob("specs/*.rv"), *ROOT.glob("src/rvmon/language/patterns/*.rv")])


def rules():
    """The patterns in order, compiled."""
    for pattern in GRAMMAR["patterns"]:
        rule = GRAMMAR["repository"][pattern["include"][1:]]
        yield re.compile(rule["match"]), rule


RULES = list(rules())


def tokens(line):
    """What a TextMate engine makes of a line: at each place the first rule that matches."""
    place = 0
    found = []
    while place < len(line):
        for pattern, rule in RULES:
            match = pattern.match(line, place)
            if match and match.end() > place:
                if "name" in rule:
                    found.append((match[0].strip(), rule["name"]))
                for group, capture in rule.get("captures", {}).items():
                    if match[int(group)]:
                        found.append((match[int(group)], capture["name"]))
                place = match.end()
                break
        else:
            place += 1
    return found


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.name)
def test_specifications_are_coloured(path):
    for line in path.read_text(encoding="utf-8").splitlines():
        coloured = tokens(line)
        code = re.sub(r'"[^"]*"|#.*', "", line)
        assert len(re.findall(r"[A-Za-z_]\w*", code)) == 0 or coloured
        for text, name in coloured:
            if text in RESERVED:
                assert name.startswith(("keyword", "constant.language")), (line, text, name)
        if line.lstrip().startswith("#"):
            assert coloured[0][1].startswith("comment")


def test_every_word_of_the_language_is_known():
    """A word that is added to the language has to be added here."""
    for word in sorted(RESERVED | INFIX_WORDS):
        name = "A[" if word in "AE" else f"{word} x"
        coloured = tokens(name.replace("A", word, 1) if word in "AE" else name)[0][1]
        assert coloured.startswith(("keyword", "constant.language")), word


def test_functions_and_numbers_with_units():
    """Functions before their bracket; units belong to their number, operators do not."""
    for function in sorted(FUNCTIONS):
        assert tokens(f"x and {function}(y)")[2] == (function, "support.function.rv")
    assert tokens("d < 5.5 mm/s and x")[2:4] == [
        ("5.5", "constant.numeric.rv"),
        ("mm/s", "keyword.other.unit.rv"),
    ]
    assert ("until", "keyword.control.temporal.rv") in tokens("x < 5 until y")


def findings():
    """The findings about a file with an error."""
    from rvmon.language.compile import compile_text

    return findings_of(compile_text, 'requirement R "a \\"quote\\"" always a', name="a.rv")


def matchers():
    """The patterns that are shipped: for VS Code by the name of their form, for GitHub."""
    package = json.loads((VSCODE / "package.json").read_text(encoding="utf-8"))
    found = {one["name"]: one["pattern"] for one in package["contributes"]["problemMatchers"]}
    path = ROOT / "editors" / "github" / "problem-matcher.json"
    (github,) = json.loads(path.read_text(encoding="utf-8"))["problemMatcher"]
    return {**found, "github": github["pattern"][0]}


@pytest.mark.parametrize("name", ["rvmon", "rvmon-json", "github"])
def test_problem_matchers_read_findings(name):
    from rvmon.diagnostics import render_concise, render_json

    pattern = matchers()[name]
    render = render_json if name == "rvmon-json" else render_concise
    found = [re.match(pattern["regexp"], line) for line in render(findings()).splitlines()]
    (match,) = [one for one in found if one]
    read = {key: match[group] for key, group in pattern.items() if key != "regexp"}
    message = read.pop("message")
    expected = {"file": "a.rv", "line": "1", "column": "36", "severity": "error", "code": "RV012"}
    assert read == expected
    assert message.startswith("no signal or event named `a`")
