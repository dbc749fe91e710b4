"""Small wrong changes of C source, found by its tokens."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from rvmon.cdv.mutation.mutant import Mutant

_SWAPS = (
    ("comparison", r"(?<= )(<|<=|>|>=|==|!=)(?= )", ("<", "<=", ">", ">=", "==", "!=")),
    ("and/or", r"(?<= )(&&|\|\|)(?= )", ("&&", "||")),
    ("operator", r"(?<= )(\+|-)(?= (?!1\b))", ("+", "-")),
    ("constant", r"\b(true|false)\b", ("true", "false")),
    ("constant", r"\b(IS_TRUE|IS_FALSE)\b", ("IS_TRUE", "IS_FALSE")),
    ("constant", r"(?<=[ (])([01])(?=[;,) ])", ("0", "1")),
    ("operator", r"(?<= )(&|\|)(?= )", ("&", "|")),
    ("operator", r"(?<= )(\*|/)(?= )", ("*", "/")),
)
"""Kind, what is looked for, and the words of which each is replaced by its neighbour in a pair."""

_NEGATED = re.compile(r"^\s+(?:\} else )?if (\(.+\)) \{$")
"""A condition that stands on one line."""

_DROPS = (
    ("off by one", r" [+-] 1\b(?!\])"),
    ("dropped not", r"!(?=[a-z(])"),
    ("dropped statement", r"(?<=^)\s+(?:break|continue);$"),
    ("dropped statement", r"^\s+[a-z][\w\->\[\].*]* (?:[-+|&]?=) [^;{}]*;$"),
    ("dropped statement", r"^\s+[a-z]\w*\([^;{}]*\);$"),
)


def c_mutants(path: Path) -> Iterator[Mutant]:
    """All changes that are tried in a C file, outside comments, directives and declarations."""
    source = path.read_text(encoding="utf-8")
    at = 0
    comment = False
    for number, line in enumerate(source.splitlines(keepends=True), start=1):
        begins, ends = "/*" in line, "*/" in line
        code = not (comment or begins or line.startswith(("#", "static const", "typedef")))
        if code and line.startswith(" "):
            for kind, start, end, text in _changes(line.rstrip("\n")):
                changed = source[: at + start] + text + source[at + end :]
                after = (line[:start] + text + line[end:]).strip()
                yield Mutant(path, number, kind, line.strip(), after, changed)
        comment = (comment or begins) and not ends
        at += len(line)


def _changes(line: str) -> Iterator[tuple[str, int, int, str]]:
    for kind, pattern, words in _SWAPS:
        for found in re.finditer(pattern, line):
            index = words.index(found[1])
            yield kind, found.start(1), found.end(1), words[index ^ 1]
    if found := _NEGATED.match(line):
        yield "negated condition", found.start(1), found.end(1), f"(!{found[1]})"
    for kind, pattern in _DROPS:
        for found in re.finditer(pattern, line):
            text = ";" if kind == "dropped statement" else ""
            yield kind, found.start(), found.end(), text
