"""An open document: its text with positions, its compilation, and answers for editors."""

from __future__ import annotations

import os
import re
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property
from importlib import resources
from itertools import islice
from pathlib import Path

from lsprotocol import types as lsp
from pygls.uris import from_fs_path, to_fs_path

from rvmon.analysis.diagnostic_codes import page_of
from rvmon.cli.lsp.names import Names
from rvmon.diagnostics import Diagnostic, Severity, Source, Span
from rvmon.files import cache_folder, write_whole
from rvmon.language.compile import Compilation, compilation
from rvmon.language.syntax.expressions import Ident
from rvmon.language.syntax.items import Declarations, ImportItem, Item, SignalSyntax
from rvmon.language.syntax.keywords import split_items
from rvmon.texts import escaped, proposed

_WIDTHS = {
    lsp.PositionEncodingKind.Utf8: (0x80, 0x800, 0x10000),
    lsp.PositionEncodingKind.Utf16: (0x10000,),
    lsp.PositionEncodingKind.Utf32: (),
}
"""By encoding, the code points from which a character takes one code unit more."""


class Text:
    """A text with its lines.

    It replaces that of pygls, which would also end lines at a form feed or U+2028, unlike editors.

    Source: Language Server Protocol 3.17, Text Documents and Position.
    """

    def __init__(self, raw: str, encoding: str = lsp.PositionEncodingKind.Utf16) -> None:
        self.raw = raw
        self.encoding = encoding
        self._widths = _WIDTHS[lsp.PositionEncodingKind(encoding)]
        self._starts = [0, *(end.end() for end in re.finditer(r"\r\n|\r|\n", raw))]

    @property
    def code(self) -> str:
        """The text to compile: with line ends of the language, and the same offsets."""
        return self.raw.replace("\r\n", " \n").replace("\r", "\n")

    def position(self, offset: int) -> lsp.Position:
        r"""The position of the character at an offset.

        >>> Text("# 😋\nspec a").position(3).character
        4
        """
        line = bisect_right(self._starts, offset) - 1
        column = sum(map(self._width, self.raw[self._starts[line] : offset]))
        return lsp.Position(line, column)

    def range(self, start: int, end: int) -> lsp.Range:
        """The range of the characters from offset `start` to `end`."""
        return lsp.Range(self.position(start), self.position(end))

    def offset(self, position: lsp.Position) -> int:
        """The offset of the character at a position; at most the end of its line."""
        if position.line >= len(self._starts):
            return len(self.raw)
        place = self._starts[position.line]
        units = 0
        for char in self.raw[place : place + position.character]:
            units += self._width(char)
            if units > position.character or char in "\r\n":
                break
            place += 1
        return place

    def changed(self, change: lsp.TextDocumentContentChangeEvent) -> Text:
        """The text after an edit."""
        if not isinstance(change, lsp.TextDocumentContentChangePartial):
            return Text(change.text, self.encoding)
        start, end = self.offset(change.range.start), self.offset(change.range.end)
        return Text(self.raw[:start] + change.text + self.raw[end:], self.encoding)

    def _width(self, char: str) -> int:
        return 1 + bisect_right(self._widths, ord(char))


MOST_FIXES = 5  # the most diagnostics at a place whose fixes are tried

_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
}
_UNNEEDED = ("never-read", "unused-name")
_KINDS = {
    "signal": lsp.SymbolKind.Variable,
    "event": lsp.SymbolKind.Event,
    "define": lsp.SymbolKind.Function,
    "const": lsp.SymbolKind.Constant,
    "requirement": lsp.SymbolKind.Class,
    "property": lsp.SymbolKind.Property,
    "cover": lsp.SymbolKind.Key,
    "coverpoint": lsp.SymbolKind.Enum,
    "cross": lsp.SymbolKind.Array,
}
_HEAD = re.compile(r"(\w+)\s+(`[^`\n]+`|[^\W\d][\w.]*)")

Key = tuple[str, int]  # identifies a declaration in all documents: its file and offset


class Document:
    """A compiled text, which may have errors; `read` returns the text of an imported file."""

    def __init__(self, uri: str, text: Text, read: Callable[[Path], str]) -> None:
        self.uri = uri
        self.text = text
        self._read = read
        path = to_fs_path(uri)
        self._folder = Path(path).parent if path else None
        self.source = Source(path or uri, text.code)
        self.compiled = self._compiled(self.source)
        self.names = Names(self.compiled.files)

    def _compiled(self, source: Source) -> Compilation:
        return compilation(source, self._folder, {}, self._read)

    def place(self, position: lsp.Position) -> Span:
        """The empty span at a position in the text."""
        offset = self.text.offset(position)
        return Span(self.source, offset, offset)

    @cached_property
    def _texts(self) -> dict[int, Text]:
        return {id(self.source): self.text}

    def location(self, span: Span) -> lsp.Location:
        """The location of a span in this text or in an imported one."""
        source = span.source
        if id(source) not in self._texts:
            self._texts[id(source)] = Text(source.text, self.text.encoding)
        where = self._texts[id(source)].range(span.start, span.end)
        return lsp.Location(self.uri if source is self.source else _address(source), where)

    @cached_property
    def diagnostics(self) -> dict[str, list[lsp.Diagnostic]]:
        """The diagnostics by the URI of their file."""
        by_address: dict[str, list[lsp.Diagnostic]] = {self.uri: []}
        for finding in self.compiled.findings:
            spans = finding.spans
            place = self.location(spans[0].span if spans else Span(self.source, 0, 0))
            by_address.setdefault(place.uri, []).append(self._diagnostic(finding, place.range))
        return by_address

    def _diagnostic(self, finding: Diagnostic, where: lsp.Range) -> lsp.Diagnostic:
        help_ = f"\nhelp: {finding.help}" if finding.help else ""
        return lsp.Diagnostic(
            where,
            escaped(finding.message + help_),
            _SEVERITIES[finding.severity],
            finding.code,
            _page(finding.code),
            "rvmon",
            [lsp.DiagnosticTag.Unnecessary] if finding.name in _UNNEEDED else None,
            [
                lsp.DiagnosticRelatedInformation(
                    self.location(label.span), escaped(label.text) or "with this"
                )
                for label in finding.spans[1:]
            ],
        )

    def fixes(self, where: lsp.Range) -> Iterator[lsp.CodeAction]:
        """The fixes of diagnostics in a range; only those that leave fewer errors or warnings."""
        start, end = self.text.offset(where.start), self.text.offset(where.end)
        proposals = (
            (finding, finding.spans[0].span, proposed(finding.help))
            for finding in self.compiled.findings
            if finding.spans and finding.spans[0].span.source is self.source
        )
        inside = (p for p in proposals if p[2] and p[1].start <= end and start <= p[1].end)
        for finding, span, instead in islice(inside, MOST_FIXES):
            text = self.source.text[: span.start] + instead + self.source.text[span.end :]
            if _badness(self._compiled(Source(self.source.name, text))) < _badness(self.compiled):
                place = self.text.range(span.start, span.end)
                yield lsp.CodeAction(
                    f"Write `{instead}`",
                    lsp.CodeActionKind.QuickFix,
                    [self._diagnostic(finding, place)],
                    True,
                    edit=lsp.WorkspaceEdit({self.uri: [lsp.TextEdit(place, instead)]}),
                )

    def symbols(self) -> Iterator[lsp.DocumentSymbol]:
        """The declarations and requirements of the text; of an unreadable item only the name."""
        read = {item.span.start: item for item in self.compiled.files[0].items}
        for start, end in split_items(self.source.text):
            head = _HEAD.match(self.source.text, start, end)
            if head is None or head[1] not in _KINDS:
                continue
            item = read.get(start)
            whole = item.span if item else Span(self.source, start, head.end())
            names = [name.span for name in _declared(item)] if item else []
            for name in names or [Span(self.source, *head.span(2))]:
                yield lsp.DocumentSymbol(
                    name.text,
                    _KINDS[head[1]],
                    self.location(whole if len(names) < 2 else name).range,
                    self.location(name).range,
                    _detail(item) if item else "has errors",
                )

    def definitions(self, position: lsp.Position) -> list[lsp.Location]:
        """The declaration of the name at a position, or the files imported there."""
        place = self.place(position)
        item = self.names.item_at(place)
        if isinstance(item, ImportItem):
            file = str((self._folder or Path()) / item.target)
            sources = (file.source for file in self.compiled.files[1:])
            meant = (
                s for s in sources if s.name == file or str(Path(s.name).parent) == item.target
            )
            return [self.location(Span(source, 0, 0)) for source in meant]
        use = self.names.at(place)
        return [self.location(use[1].span)] if use else []

    def key(self, position: lsp.Position) -> Key | None:
        """The key of the declaration of the name at a position; `None` if there is none."""
        use = self.names.at(self.place(position))
        return _key(use[1]) if use else None

    def uses(self, key: Key) -> Iterator[Span]:
        """The spans of all names that refer to a declaration."""
        return (span for span, target in self.names.all() if _key(target) == key)


def _badness(compiled: Compilation) -> tuple[int, int]:
    findings = compiled.findings
    return sum(diagnostic.severity is Severity.ERROR for diagnostic in findings), len(findings)


def _page(code: str) -> lsp.CodeDescription | None:
    """The page of a diagnostic code as a file that editors open; `None` if it cannot be written."""
    folder = cache_folder()
    with suppress(OSError):
        return None if folder is None else _kept_page(folder / "codes" / f"{code}.md", code)
    return None


@cache
def _kept_page(path: Path, code: str) -> lsp.CodeDescription:
    path.parent.mkdir(mode=0o700, exist_ok=True)
    write_whole(str(path), page_of(code))
    return lsp.CodeDescription(path.as_uri())


def _address(source: Source) -> str:
    """The URI of an imported file; the name of a shipped library is no absolute path."""
    if os.path.isabs(source.name):
        return str(from_fs_path(os.path.normpath(source.name)))
    return str(from_fs_path(str(resources.files("rvmon.language") / source.name)))


def _declared(item: Item) -> list[Ident]:
    if isinstance(item, Declarations):
        return [one.name for one in item.each]
    return [item.name] if hasattr(item, "name") else []


def _detail(item: Item) -> str:
    if isinstance(item, Declarations) and isinstance(item.each[0], SignalSyntax):
        return item.each[0].type.span.text
    return getattr(item, "text", "")


def _key(name: Ident) -> Key:
    return os.path.normpath(name.span.source.name), name.span.start
