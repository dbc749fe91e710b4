"""Parses a specification and the files it imports into syntax trees.

Each item is parsed on its own, so that all syntax errors of a file appear at once.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

import lark
from lark.exceptions import UnexpectedInput

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.rules import Findings, Refusal
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import syntax as rules
from rvmon.language.rules.syntax import LARGEST
from rvmon.language.syntax import keywords
from rvmon.language.syntax.expressions import Expression
from rvmon.language.syntax.grammar_cache import parser_of
from rvmon.language.syntax.items import ImportItem, Item, ParsedSpec
from rvmon.language.syntax.syntax_errors import explain_unexpected
from rvmon.language.syntax.tree_builder import Builder
from rvmon.texts import ImportTree, nearest, text_of_file, tree_of
from rvmon.units import compound_pattern

DEEPEST = 100  # expressions nested more deeply are refused

MOST_ENCLOSED = 200
"""The same limit if brackets that only enclose are counted, which are not levels of nesting."""

KEPT = 4_000  # the number of parse trees of items in the cache of `_tree`

_NO_CODE = re.compile(r'"[^"\n]*"|`[^`\n]*`|#[^\n]*')
_OPERATOR = re.compile(r"(?<![\w.])(?:and|or|xor|implies|iff)(?![\w.])|&&?|\|\|?|[+*]")

Parsed = tuple[Any, list[Diagnostic]]


def parse_spec(source: Source, findings: Findings) -> ParsedSpec:
    """Parse a file; items with syntax errors are left out and reported to `findings`."""
    items: list[Item] = []
    doubtful: set[str] = set()
    waiting = keywords.split_items(source.text)[::-1]
    while waiting:
        start, end = waiting.pop()
        item, wrong = _parse(source, start, end, "item")
        if item is not None:
            items.append(item)
            findings.extend(wrong)
            continue
        # The item may have swallowed the next one, whose keyword is misspelled. If it is split
        # there, its first part parses, and the error is reported at the misspelled keyword.
        cut = _misspelled_item(source.text, start, wrong)
        if cut is not None:
            waiting += ((cut, end), (start, cut))
            continue
        findings.extend(wrong)
        doubtful.update(re.findall(r"\w[\w.]*", source.text[start:end]))
    return ParsedSpec(source, tuple(items), frozenset(doubtful))


def _misspelled_item(text: str, start: int, findings: list[Diagnostic]) -> int | None:
    """The start of a misspelled item, such as `requirment R2`, inside the item before it.

    `None` if the syntax error in `findings` is something else.
    """
    place = findings[0].spans[0].span.start
    if place <= start or text[place - 1] != "\n":
        return None
    word = re.compile(r"\w+").match(text, place)
    return place if word and nearest(word[0], keywords.ITEM_WORDS, 0.75) else None


def parse_expression(source: Source) -> tuple[Expression | None, list[Diagnostic]]:
    """Parse a text that is one expression, such as the value of a constant."""
    return _parse(source, 0, len(source.text), "expression")


def _parse(source: Source, start: int, end: int, rule: str) -> Parsed:
    text = source.text[start:end]
    # The text has at least these operators. They are counted before parsing because the parser
    # takes time and memory for each.
    if len(text) >= LARGEST and len(_OPERATOR.findall(_NO_CODE.sub("", text))) > LARGEST:
        return None, [rules.too_large(Span(source, start, start + len(text.rstrip())), LARGEST)]
    builder = Builder(source, start)
    try:
        tree = _tree(text, rule)
        if (part := _too_deep(tree)) is not None:
            place = Span(source, start + part.meta.start_pos, start + part.meta.end_pos)
            return None, [rules.too_deep(place, DEEPEST)]
        return builder.built(tree), builder.findings
    except UnexpectedInput as error:
        return None, [explain_unexpected(error, grammar(), source, start, end, rule)]
    except Refusal as refusal:
        return None, [refusal.finding]


@lru_cache(KEPT)
def _tree(text: str, rule: str) -> lark.Tree[Any]:
    """The parse tree of a text, cached so that editing one item does not parse all others again."""
    return grammar().parse(text, start=rule)


@cache
def grammar() -> lark.Lark:
    """The parser, built once per process."""
    return parser_of(grammar_text(), GRAMMAR_OPTIONS)


GRAMMAR_OPTIONS: dict[str, Any] = {
    "parser": "lalr",
    "lexer": "contextual",
    "start": ["item", "expression"],
    "propagate_positions": True,
    "maybe_placeholders": False,
}


def grammar_text() -> str:
    """The grammar, with placeholders replaced from the tables of words and units."""
    text = resources.files("rvmon.language.syntax").joinpath("rv.lark").read_text(encoding="utf-8")
    end = r"(?!\w|\.\w)"
    word = r"[^\W\d]\w*"
    fillings = {
        "END": end,
        "NAME": rf"(?!({_any(keywords.RESERVED)}){end}){word}(\.{word})*",
        "UNIT": rf"(?!({_any(keywords.NOT_UNITS)}){end}){word}",
        "COMPOUND": compound_pattern(keywords.NOT_UNITS).replace("/", r"\/"),
    }
    for terminal, spellings in keywords.OPERATOR_TERMINALS.items():
        fillings[terminal] = "|".join(
            re.escape(spelling).replace(r"\ ", r"\s+") + (end if spelling[-1].isalpha() else "")
            # The longest first, `&&` before `&`: an alternation takes the first match.
            for spelling in sorted(spellings, key=len, reverse=True)
        )
    for key, pattern in fillings.items():
        text = text.replace(f"@{key}@", pattern)
    return text


def _any(words: frozenset[str]) -> str:
    return "|".join(sorted(words))


def _too_deep(tree: lark.Tree[Any]) -> lark.Tree[Any] | None:
    """The first part that is nested too deeply, or `None`.

    Brackets that only enclose are not levels of nesting, but have a limit of their own.
    """
    within = 0
    level = [tree]
    for _ in range(MOST_ENCLOSED):
        level = [part for node in level for part in node.children if isinstance(part, lark.Tree)]
        within += any(node.data != "group" for node in level)
        if not level:
            return None
        if within >= DEEPEST:
            break
    return level[0]


LIBRARIES = ("patterns",)
"""Libraries that can be imported by name: folders of `rvmon.language` with `.rv` files."""


def load_files(
    source: Source,
    directory: Path | None,
    findings: Findings,
    read: Callable[[Path], str] = text_of_file,
) -> list[ParsedSpec]:
    """Parse a file and all files it imports, directly or indirectly.

    The main file comes first, then the others in the order of their first import. `directory` is
    the folder of the main file, by default the current one. `read` returns the text of an imported
    file.
    """
    loader = _Loader(findings, tree_of(directory or Path()), read)
    loader.read(source, directory or Path(), _key(Path(source.name)), {})
    return loader.files


class _Loader:
    def __init__(self, findings: Findings, tree: ImportTree, read: Callable[[Path], str]) -> None:
        self.files: list[ParsedSpec] = []
        self._findings = findings
        self._tree = tree
        self._text = read
        self._seen: set[str] = set()

    def read(
        self, source: Source, directory: Path, key: str, path: Mapping[str, ImportItem]
    ) -> None:
        """Parse a file and its imports.

        `path` is the chain of imports that leads here: the import item by the key of its file.
        """
        self._seen.add(key)
        parsed = parse_spec(source, self._findings)
        self.files.append(parsed)
        for item in parsed.items:
            if isinstance(item, ImportItem):
                self._import(item, directory, {**path, key: item})

    def _import(self, item: ImportItem, directory: Path, path: Mapping[str, ImportItem]) -> None:
        try:
            for source, folder, key in self._sources(item, directory):
                if key in path:
                    self._findings.add(name_rules.circle(item.span, path[key].span))
                elif len(path) > name_rules.DEEPEST:
                    raise Refusal(name_rules.too_deep(item.span))
                elif key not in self._seen:
                    self.read(source, folder, key, path)
        except Refusal as refusal:
            self._findings.add(refusal.finding)

    def _sources(self, item: ImportItem, directory: Path) -> Iterator[tuple[Source, Path, str]]:
        """The texts behind an import, each with its folder and a unique key."""
        if not item.library:
            path = directory / item.target
            yield Source(str(path), self._read(path, item)), path.parent, _key(path)
            return
        if item.target not in LIBRARIES:
            raise Refusal(name_rules.unknown_library(item.span, item.target, ", ".join(LIBRARIES)))
        folder = resources.files("rvmon.language") / item.target
        for file in sorted(folder.iterdir(), key=lambda entry: entry.name):
            if file.name.endswith(".rv"):
                name = f"{item.target}/{file.name}"
                text = file.read_text(encoding="utf-8")
                yield Source(name, text), Path(), f"library {name}"

    def _read(self, file: Path, item: ImportItem) -> str:
        try:
            if not self._tree.holds(file):
                raise Refusal(name_rules.outside(item.span, item.target, str(self._tree.root)))
            return self._text(file)
        except OSError as error:
            reason = error.strerror or str(error)
        except UnicodeDecodeError:
            reason = "it is not UTF-8 text"
        except ValueError as error:  # a null character in the path
            reason = str(error)
        raise Refusal(name_rules.unreadable(item.span, item.target, reason))


def _key(path: Path) -> str:
    return os.path.abspath(path)
