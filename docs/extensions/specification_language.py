"""Grammar, words and tables of the specification language, and its syntax highlighting."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import resources

from grammar import productions
from pygments.lexer import RegexLexer, words
from pygments.token import Comment, Keyword, Name, Number, Operator, String, Whitespace

from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import Measured
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.syntax.keywords import CLAUSE_WORDS, INFIX_WORDS, OPERATOR_TERMINALS, RESERVED

_READ_AS = {
    "NAME": "plain-name",
    "UNIT": "unit-name",
    "COMPOUND": "compound-unit",
}
"""Replacements for the parts of the grammar that are built from all words of the language."""


def grammar() -> str:
    """The EBNF of specifications as Markdown."""
    text = resources.files("rvmon.language.syntax").joinpath("rv.lark").read_text(encoding="utf-8")
    text = text.replace("/@NAME@\\(/", 'NAME "("')
    for terminal, spellings in OPERATOR_TERMINALS.items():
        written = " | ".join(f'"{one}"' for one in spellings)
        text = text.replace(f"/@{terminal}@/", written)
    for place, name in _READ_AS.items():
        text = text.replace(f"@{place}@", f"<{name}>")
    return ebnf(text)


def model_grammar() -> str:
    """The EBNF of models (`.ta`) as Markdown."""
    path = resources.files("rvmon.models.language").joinpath("ta.lark")
    return ebnf(path.read_text(encoding="utf-8"))


def ebnf(text: str) -> str:
    """A Lark grammar as a block of EBNF."""
    shown = [
        f"{name} ::= " + right.replace("\n", "\n" + " " * (len(name) + 3))
        for name, right in productions(text)
    ]
    return "```text\n" + "\n".join(shown) + "\n```\n"


def operations() -> str:
    """The table of operations on numbers: arguments and results."""
    rows = [
        f"| `{op}` | {op.entry.unit.value} | {op.entry.exactness} |"
        for op in NumericOp
        if op is not NumericOp.NEG
    ]
    return "\n".join(("| | takes; gives | result |", "|---|---|---|", *rows))


def windows() -> str:
    """The table of window functions."""
    rows = [
        f"| `{one}` | {one.of.value}; {one.dimension.value} | {one.doc} | {one.unknown} "
        f"| {one.memory} |"
        for one in Measured
    ]
    heads = "| | takes; gives | | if something is unknown | memory |"
    return "\n".join((heads, "|---|---|---|---|---|", *rows))


def reserved_words() -> str:
    """The words of the language as Markdown, from the tables of the parser."""
    kinds = {
        "Never names, but in backticks": RESERVED,
        "Operators between formulas; names where an operand stands": INFIX_WORDS,
        "At the start of a clause; names elsewhere": CLAUSE_WORDS,
        "Functions, before a bracket; names elsewhere": FUNCTIONS.keys(),
    }
    return "\n\n".join(f"{kind}: {_listed(found)}." for kind, found in kinds.items())


def _listed(found: Iterable[str]) -> str:
    plain = {word for word in found if re.match(r"\w", word)}
    return ", ".join(f"`{word}`" for word in sorted(plain, key=str.lower))


class SpecificationLexer(RegexLexer):
    """Pygments lexer of `.rv` files."""

    name = "rvmon specification"
    aliases = ("rv",)
    filenames = ("*.rv",)
    tokens = {  # noqa: RUF012 - required by Pygments
        "root": [
            (r"\s+", Whitespace),
            (r"#[^\n]*", Comment.Single),
            (r'"[^"\n]*"', String),
            (r"`[^`\n]*`", Name),
            (r"\d+(\.\d+)?([ \t]*[^\W\d]\w*(/\w+)?(?=[\s,)\]]))?", Number),
            (words(sorted(RESERVED | INFIX_WORDS), prefix=r"\b", suffix=r"\b(?!\.)"), Keyword),
            (words(sorted(CLAUSE_WORDS), prefix=r"\b", suffix=r"\b(?!\.)"), Keyword.Pseudo),
            (r"[^\W\d][\w.]*", Name),
            (r".", Operator),
        ]
    }
