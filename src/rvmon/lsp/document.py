"""A document compiled as far as it goes, and what editors ask about it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from importlib import resources
from itertools import islice
from pathlib import Path

from lsprotocol import types as lsp
from pygls.uris import from_fs_path, to_fs_path

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.nearest import proposed
from rvmon.diagnostics.shown import shown
from rvmon.diagnostics.span import Source, Span
from rvmon.diagnostics.text_file import refuse_large
from rvmon.errors import RvmonError
from rvmon.lsp.code_pages import page_uri
from rvmon.lsp.names import Names
from rvmon.lsp.text import Text
from rvmon.spec.compile import Compilation, compilation
from rvmon.spec.print.printer import format_name
from rvmon.spec.syntax.expressions import Ident
from rvmon.spec.syntax.items import EventItem, ImportItem, Item, ParsedSpec, SignalItem
from rvmon.spec.syntax.split import split_items

MOST_FIXES = 5
"""Of so many findings at a place it is tried whether what they propose helps."""

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

Key = tuple[str, int]
"""A declaration, the same in all documents: its file, and where in that it is."""


class Document:
    """A text that is being written.

    Args:
        uri: what the editor calls it.
        text: as it is now.
        read: gives the text of a file that it imports.
    """

    def __init__(self, uri: str, text: Text, read: Callable[[Path], str]) -> None:
        self.uri = uri
        self.text = text
        self._read = read
        path = to_fs_path(uri)
        self._folder = Path(path).parent if path else None
        try:
            refuse_large(len(text.raw))
            self.source = Source(path or uri, text.code)
            self.compiled = self._compiled(self.source, read)
        except OSError as error:
            self.source = Source(path or uri, "")
            found = Diagnostic("", "too-large", Severity.ERROR, f"this is {error.strerror}")
            self.compiled = Compilation((ParsedSpec(self.source, ()),), None, (found,))
        self.names = Names(self.compiled.files)

    def _compiled(self, source: Source, read: Callable[[Path], str]) -> Compilation:
        return compilation(source, self._folder, {}, read)

    def place(self, position: lsp.Position) -> Span:
        """A position in the text."""
        offset = self.text.offset(position)
        return Span(self.source, offset, offset)

    @cached_property
    def _texts(self) -> dict[int, Text]:
        return {id(self.source): self.text}

    def location(self, span: Span) -> lsp.Location:
        """A place in this text or in one that it imports."""
        source = span.source
        if id(source) not in self._texts:
            self._texts[id(source)] = Text(source.text, self.text.encoding)
        where = self._texts[id(source)].range(span.start, span.end)
        return lsp.Location(self.uri if source is self.source else _address(source), where)

    @cached_property
    def diagnostics(self) -> dict[str, list[lsp.Diagnostic]]:
        """What is wrong, by the address of the file that it is in."""
        found: dict[str, list[lsp.Diagnostic]] = {self.uri: []}
        for finding in self.compiled.findings:
            spans = finding.spans
            place = self.location(spans[0].span if spans else Span(self.source, 0, 0))
            found.setdefault(place.uri, []).append(self._diagnostic(finding, place.range))
        return found

    def _diagnostic(self, finding: Diagnostic, where: lsp.Range) -> lsp.Diagnostic:
        help_ = f"\nhelp: {finding.help}" if finding.help else ""
        page = page_uri(finding.code)
        return lsp.Diagnostic(
            where,
            shown(finding.message + help_),
            _SEVERITIES[finding.severity],
            finding.code,
            lsp.CodeDescription(page) if page else None,
            "rvmon",
            [lsp.DiagnosticTag.Unnecessary] if finding.name in _UNNEEDED else None,
            [
                lsp.DiagnosticRelatedInformation(
                    self.location(label.span), shown(label.text) or "with this"
                )
                for label in finding.spans[1:]
            ],
        )

    def fixes(self, where: lsp.Range) -> Iterator[lsp.CodeAction]:
        """What findings in a range propose to write instead, if the compiler agrees."""
        start, end = self.text.offset(where.start), self.text.offset(where.end)
        proposals = (
            (finding, finding.spans[0].span, proposed(finding.help))
            for finding in self.compiled.findings
            if finding.spans and finding.spans[0].span.source is self.source
        )
        inside = (p for p in proposals if p[2] and p[1].start <= end and start <= p[1].end)
        for finding, span, instead in islice(inside, MOST_FIXES):
            text = self.source.text[: span.start] + instead + self.source.text[span.end :]
            after = self._compiled(Source(self.source.name, text), self._read)
            if len(after.findings) < len(self.compiled.findings):
                place = self.text.range(span.start, span.end)
                yield lsp.CodeAction(
                    f"Write `{instead}`",
                    lsp.CodeActionKind.QuickFix,
                    [self._diagnostic(finding, place)],
                    True,
                    edit=lsp.WorkspaceEdit({self.uri: [lsp.TextEdit(place, instead)]}),
                )

    def symbols(self) -> Iterator[lsp.DocumentSymbol]:
        """What the text declares and demands; of an item that cannot be read its name."""
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
                    _detail(item) if item else "cannot be read",
                )

    def definitions(self, position: lsp.Position) -> list[lsp.Location]:
        """Where the name at a position is declared, or the files that are imported there."""
        place = self.place(position)
        item = self.names.item_at(place)
        if isinstance(item, ImportItem):
            folder = self._folder or Path()
            named = f"{item.target}/" if item.library else str(folder / item.target)
            sources = (file.source for file in self.compiled.files[1:])
            return [self.location(Span(s, 0, 0)) for s in sources if s.name.startswith(named)]
        found = self.names.at(place)
        return [self.location(found[1].span)] if found else []

    def key(self, position: lsp.Position) -> Key | None:
        """The declaration that the name at a position stands for."""
        found = self.names.at(self.place(position))
        return _key(found[1]) if found else None

    def uses(self, key: Key) -> Iterator[Span]:
        """All places of the names that stand for a declaration."""
        return (span for span, target in self.names.all() if _key(target) == key)

    def renamed(self, key: Key, name: str) -> dict[str, list[lsp.TextEdit]]:
        """The edits that rename what is declared, by address.

        Raises:
            RvmonError: the name is none, or something would mean another thing afterwards.
        """
        if not os.path.isabs(key[0]) and key[0] != os.path.normpath(self.source.name):
            raise RvmonError("what a library of rvmon declares keeps its name")
        if not re.fullmatch(r"[^`\n]*[^`\s][^`\n]*", name):
            raise RvmonError("a name is on one line and has no backticks")
        if any(file.doubtful for file in self.compiled.files):
            raise RvmonError("some items cannot be read, and may hold the name: correct them first")
        written = format_name(name)
        spans = list(dict.fromkeys(self.uses(key)))
        texts = {file.source.name: file.source.text for file in self.compiled.files}
        for span in sorted(spans, key=lambda span: -span.start):
            text = texts[span.source.name]
            texts[span.source.name] = text[: span.start] + written + text[span.end :]
        after = self._compiled(
            Source(self.source.name, texts[self.source.name]),
            lambda path: texts.get(str(path)) or self._read(path),
        )
        same = _structure(Names(after.files)) == _structure(self.names)
        if not same or len(after.findings) > len(self.compiled.findings):
            raise RvmonError(f"something would mean another thing if this were called `{name}`")
        edits: dict[str, list[lsp.TextEdit]] = {}
        for span in spans:
            place = self.location(span)
            edits.setdefault(place.uri, []).append(lsp.TextEdit(place.range, written))
        return edits


def _address(source: Source) -> str:
    """The address of an imported file; those of libraries have no path as name."""
    if os.path.isabs(source.name):
        return str(from_fs_path(os.path.normpath(source.name)))
    return str(from_fs_path(str(resources.files("rvmon.spec") / source.name)))


def _declared(item: Item) -> list[Ident]:
    match item:
        case SignalItem(names=names):
            return list(names)
        case EventItem(events=events):
            return [event.name for event in events]
        case _:
            return [item.name] if hasattr(item, "name") else []


def _detail(item: Item) -> str:
    if isinstance(item, SignalItem):
        return item.type.span.text
    return getattr(item, "text", "")


def _key(name: Ident) -> Key:
    return os.path.normpath(name.span.source.name), name.span.start


def _structure(names: Names) -> list[int]:
    """Which places of names stand for the same thing, whatever that is called."""
    numbers: dict[Key, int] = {}
    return [numbers.setdefault(_key(target), len(numbers)) for _, target in names.all()]
