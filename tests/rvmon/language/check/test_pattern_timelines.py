"""The timelines of the pattern page are correct for every pattern in every scope."""

import re
from functools import cache
from importlib import resources

import pytest

from rvmon.language.compile import compile_text
from rvmon.testing import oracle
from rvmon.trace.sample import Sample

LIBRARY = resources.files("rvmon.language") / "patterns"
LETTERS = "pqrstz"
DEFINITION = re.compile(r"define (\w+)\(([\w, ]+)\)")
TIMELINE = re.compile(r"\b(P|F|NT|I) (everywhere|before r|after q until r|after q|between q r):")
SCOPES = {
    "everywhere": "",
    "before r": "scope before (r)",
    "after q": "scope after (q)",
    "between q r": "scope between (q) and (r)",
    "after q until r": "scope after (q) until (r)",
}


def timelines():
    for file in sorted(LIBRARY.iterdir(), key=lambda entry: entry.name):
        waiting = []
        for line in file.read_text().splitlines():
            found = list(TIMELINE.finditer(line))
            for number, match in enumerate(found):
                end = found[number + 1].start() if number + 1 < len(found) else len(line)
                waiting.append((match[2], match[1], line[match.end() : end].split()))
            if definition := DEFINITION.match(line):
                name, parameters = definition[1], definition[2]
                call = f"{name}({parameters.replace('d', '2 ns')})"
                for scope, verdict, words in waiting:
                    yield call, scope, verdict, words
                waiting = []


ALL = list(timelines())


@cache
def compiled(call, scope):
    """A specification with the pattern."""
    return compile_text(f"""spec demo
time sampled
import patterns
signal {", ".join(LETTERS)} : bool
requirement R {call} {SCOPES[scope]}
""")[0]


@pytest.mark.law
def test_timelines():
    """The verdict of a timeline is the letter before its colon."""
    for call, scope, verdict, words in ALL:
        samples = [
            Sample(t, {letter: letter in word for letter in LETTERS})
            for t, word in enumerate(words)
        ]
        found = oracle.evaluate(compiled(call, scope), samples).verdicts["R"]
        assert found == verdict, (call, scope, words)


def test_every_pattern_has_a_timeline_in_every_scope():
    patterns = {
        name
        for file in LIBRARY.iterdir()
        for name in re.findall(r"^define (\w+)", file.read_text(), re.MULTILINE)
    }
    tested = {(call.split("(")[0], scope) for call, scope, _, _ in ALL}
    assert tested == {(pattern, scope) for pattern in patterns for scope in SCOPES}
    assert len(patterns) == 17
