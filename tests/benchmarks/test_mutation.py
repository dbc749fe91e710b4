"""Mutations of source files."""

import ast

from benchmarks.mutants import KINDS
from benchmarks.mutation_c import c_mutants

from rvmon.cdv.mutation.source import mutants

PYTHON = '''\
LIMIT = 3


def judge(a: int | None, b: list[int]) -> int | None:
    """Not mutated: 1 + 1."""
    t: int = 0
    for x, y in zip(b, b, strict=True):
        if not a or x < y - 1:
            t += 1  # größer
            continue
    return min(b) if a is None else t
'''

C = """\
/* if (a < 1) { */
#define LIMIT (1 < 2)
static bool judge(int a, int b)
{
    bool found = false;
    if ((a < b) && !ready(a)) {
        found = a == b - 1;
        note(a);
    }
    return found;
}
"""


def lines(source: str) -> set[int]:
    return set(range(1, source.count("\n") + 2))


def test_python_changes(tmp_path):
    """All kinds of change are found inside functions; annotations and checks are left alone."""
    path = tmp_path / "m.py"
    path.write_text(PYTHON, encoding="utf-8")
    found = list(mutants(path, lines(PYTHON), KINDS))
    assert {one.kind for one in found} == {
        "and/or",
        "comparison",
        "constant",
        "dropped not",
        "dropped operand",
        "dropped statement",
        "function",
        "negated condition",
        "off by one",
        "operator",
        "swapped branches",
    }
    for one in found:
        assert ast.dump(ast.parse(one.source)) != ast.dump(ast.parse(PYTHON))
        assert "größer" in one.source or one.line == 9
        assert "strict=True" in one.source
        assert "a: int | None" in one.source
    assert not list(mutants(path, {1, 2, 3}, KINDS))


def test_c_changes(tmp_path):
    """Operators, constants and statements are changed; comments and directives are not."""
    path = tmp_path / "m.c"
    path.write_text(C, encoding="utf-8")
    found = list(c_mutants(path))
    changes = {(one.line, one.kind) for one in found}
    assert changes == {
        (5, "constant"),
        (6, "and/or"),
        (6, "comparison"),
        (6, "dropped not"),
        (6, "negated condition"),
        (7, "comparison"),
        (7, "constant"),
        (7, "dropped statement"),
        (7, "off by one"),
        (8, "dropped statement"),
    }
    assert all(one.source.count("\n") == C.count("\n") for one in found)
