"""Mutants of Python code: their kinds, their names, and the third they belong to."""

import ast
import inspect
import re
from collections import Counter
from pathlib import Path

import pytest
from tests.tools.each import each

from rvmon import cdv
from rvmon.cdv.mutation import python_operators
from rvmon.cdv.mutation.python_mutants import THIRDS, code_mutants, mutants, third_of
from rvmon.errors import RvmonError

CHANGES = [
    ("comparison", "return a < b", "a <= b"),
    ("and/or", "return a and b", "a or b"),
    ("dropped operand", "return a and b", "b"),
    ("dropped not", "return not a", "a"),
    ("off by one", "return a + 1", "a"),
    ("operator", "return a * b", "a / b"),
    ("constant", "return True", "return (False)"),
    ("number", "return 2.0", "return (1.8)"),
    ("number", "return 0.0", "return 1.0"),
    ("string", "if a: return 'up'\n    return 'down'", "return 'up'"),
    ("string", "if b == 'c': pass\n    return {'a', 'b'}", "return {'a', 'b', 'd'}"),
    ("swapped branches", "return a if b else 0", "0 if b else a"),
    ("negated condition", "while a: pass", "not a"),
    ("function", "return min(a, b)", "max(a, b)"),
    ("dropped statement", "a.start(b)", "pass"),
    ("dropped assignment", "a.b = b", "pass"),
    ("dropped assignment", "c = a\n    c = b\n    return c", "pass"),
    ("dropped block", "if a: b.start()", "pass"),
    ("dropped return", "if a: return 1\n    b.start()", "pass"),
    ("early return", "a.start()\n    return 1", "return 1"),
    ("doubled statement", "a.start()", "a.start()\na.start()"),
    ("wait", "yield a\n    yield b", "2 * b"),
]

OTHER = "\ndef other(): return {'d'}\n"


@each(("kind", "body", "after"), CHANGES)
def test_operators(tmp_path, kind, body, after):
    path = tmp_path / "m.py"
    path.write_text(f"def f(a, b):\n    {body}\n{OTHER}")
    lines = range(2, 3 + body.count("\n"))
    found = [one for one in mutants(path, lines) if one.kind == kind]
    assert after in [one.after for one in found]
    for one in found:
        ast.parse(one.source)
        assert one.source.endswith(OTHER)
        assert one.identity == f"m:f:{kind.replace(' ', '-')}:{one.ordinal}"


def test_every_operator_is_tried():
    known = re.findall(r'yield "([^"]+)"', inspect.getsource(python_operators))
    assert {kind for kind, _, _ in CHANGES} == set(known)


@pytest.mark.parametrize(
    ("body", "kept"),
    [
        ("a = 1\n    return a", "a = 1"),  # otherwise its name has no value
        ("yield a", "yield a"),  # otherwise it is not a generator
        ("for c in a: yield c", "for c in a"),
        ("'what it is for'\n    a.start()", "'what it is for'"),
    ],
)
def test_statements_whose_removal_only_crashes_are_kept(tmp_path, body, kept):
    """Such mutants are killed by any suite."""
    path = tmp_path / "m.py"
    path.write_text(f"def f(a, b):\n    {body}\n")
    gone = [one for one in mutants(path, range(2, 9)) if kept not in one.source]
    assert not [one for one in gone if one.after in ("pass", "return")]


def test_thirds_follow_from_names(tmp_path):
    sizes = Counter(third_of(f"m:f:wait:{number}") for number in range(3000))
    assert set(sizes) == set(THIRDS)
    assert min(sizes.values()) > 900
    assert third_of("m:f:wait:1") == "held out"


def test_lines_before_change_no_name(tmp_path):
    path = tmp_path / "m.py"
    text = "def f(a, b):\n    return a < b or b\n"
    path.write_text(text)
    before = [(one.identity, one.third) for one in mutants(path, {2})]
    path.write_text(f"import os\n\n\n{text}")
    assert before == [(one.identity, one.third) for one in mutants(path, {5})]


def test_what_compiles_to_the_same_is_one_mutant(tmp_path):
    path = tmp_path / "m.py"
    path.write_text("def f(a, b):\n    if not a is b:\n        return 1\n")
    found = code_mutants(cdv.Code(cdv.blocks_of(path)))
    changes = [one.after for one in found]
    assert "not not a is b" in changes
    assert "a is b" not in changes


def test_constants_are_changed_where_they_are_named(tmp_path):
    path = tmp_path / "m.py"
    path.write_text("LIMIT = 3\nOTHER = 4\ndef f(): return LIMIT\n")
    found = mutants(path, (), constants=["LIMIT"])
    assert {one.after for one in found} == {"LIMIT = (4)", "LIMIT = (2)"}


@pytest.mark.parametrize(("text", "message"), [(None, "No such file"), ("def", "not Python")])
def test_what_cannot_be_read_is_told(tmp_path, text, message):
    path = Path(tmp_path, "m.py")
    if text is not None:
        path.write_text(text)
    with pytest.raises(RvmonError, match=f"m.py: {message}"):
        list(mutants(path, ()))
