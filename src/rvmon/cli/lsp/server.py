"""The language server: answers the requests of an editor."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, lsp_method
from pygls.uris import to_fs_path

from rvmon import __version__
from rvmon.cli.lsp.completion import hover, proposals
from rvmon.cli.lsp.document import Document, Text
from rvmon.cli.lsp.names import meanings
from rvmon.diagnostics import Source, Span
from rvmon.errors import SpecError
from rvmon.language.formatter import format_text
from rvmon.language.syntax.expressions import Name
from rvmon.language.syntax.parse import parse_expression
from rvmon.recordings.starter.skeletons import name_text
from rvmon.texts import text_of_file


class Protocol(LanguageServerProtocol):
    """Protocol without pygls' own handling of edits; see `Text`."""

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(
        self, params: lsp.DidChangeTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Pass the edit on unchanged."""
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CHANGE], (params,), None


QUIET = 0.2  # seconds without an edit after which diagnostics are computed

_KINDS = {
    "name": lsp.CompletionItemKind.Variable,
    "label": lsp.CompletionItemKind.EnumMember,
    "function": lsp.CompletionItemKind.Function,
    "unit": lsp.CompletionItemKind.Unit,
    "keyword": lsp.CompletionItemKind.Keyword,
}


class Server(LanguageServer):
    """The state of a session: the open texts and their documents."""

    def __init__(self) -> None:
        super().__init__("rvmon", __version__, protocol_cls=Protocol)
        for name, (answer, options) in _FEATURES.items():
            self.feature(name, options)(answer)
        self.texts: dict[str, Text] = {}
        self._documents: dict[str, Document] = {}
        self._sent: dict[str, Document] = {}

    def document(self, uri: str) -> Document:
        """The document of the current text, compiled if it has changed."""
        known = self._documents.get(uri)
        if known is None or known.text is not self.texts[uri]:
            known = self._documents[uri] = Document(uri, self.texts[uri], self._read)
        return known

    def latest(self, uri: str) -> Document:
        """The document as last compiled, perhaps of an older text; fast."""
        return self._documents.get(uri) or self.document(uri)

    def _read(self, path: Path) -> str:
        """The text of an imported file; that in the editor if it is open there."""
        wanted = os.path.abspath(path)
        open_ = (text for uri, text in self.texts.items() if to_fs_path(uri) == wanted)
        text = next(open_, None)
        return text_of_file(path) if text is None else text.code

    def take(self, uri: str, text: Text | None) -> None:
        """Set the text of a document, `None` if it was closed; reread documents with imports."""
        if text is None:
            self.texts.pop(uri, None)
        else:
            self.texts[uri] = text
        for other, document in [*self._documents.items()]:
            if other not in self.texts or (other != uri and "import" in document.source.text):
                del self._documents[other]
        # Wait only after edits, which come in quick succession.
        delay = 0 if uri not in self._sent or text is None else QUIET
        asyncio.get_running_loop().call_later(delay, self._publish_unless_changed, uri, text)

    def _publish_unless_changed(self, uri: str, text: Text | None) -> None:
        if self.texts.get(uri) is text:
            self.publish()

    def publish(self) -> None:
        """Send the diagnostics of open files, and of the files that they import."""
        documents = [self.document(uri) for uri in self.texts]
        opened = {to_fs_path(uri) for uri in self.texts}
        findings = {
            document.uri: (document, document.diagnostics[document.uri]) for document in documents
        }
        for document in documents:
            for uri, elsewhere in document.diagnostics.items():
                if to_fs_path(uri) not in opened:
                    findings.setdefault(uri, (document, elsewhere))
        for uri in self._sent.keys() - findings.keys():
            del self._sent[uri]
            self._send(uri, [])
        for uri, (document, diagnostics) in findings.items():
            if self._sent.get(uri) is not document:
                self._sent[uri] = document
                self._send(uri, diagnostics)

    def _send(self, uri: str, diagnostics: list[lsp.Diagnostic]) -> None:
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, diagnostics))


def _opened(server: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    encoding = server.workspace.position_encoding or lsp.PositionEncodingKind.Utf16
    document = params.text_document
    server.take(document.uri, Text(document.text, encoding))


def _changed(server: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    uri = params.text_document.uri
    text = server.texts[uri]
    for change in params.content_changes:
        text = text.changed(change)
    server.take(uri, text)


def _saved(server: Server, params: lsp.DidSaveTextDocumentParams) -> None:
    text = server.texts[params.text_document.uri]
    # A new object, so that the document is compiled again with its imports.
    server.take(params.text_document.uri, Text(text.raw, text.encoding))


def _closed(server: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    server.take(params.text_document.uri, None)


def _hover(server: Server, params: lsp.HoverParams) -> lsp.Hover | None:
    document = server.document(params.text_document.uri)
    word = hover(document.names, document.compiled.checked, document.place(params.position))
    if word is None:
        return None
    content = lsp.MarkupContent(lsp.MarkupKind.Markdown, word[1])
    return lsp.Hover(content, document.location(word[0]).range)


def _definition(server: Server, params: lsp.DefinitionParams) -> list[lsp.Location]:
    return server.document(params.text_document.uri).definitions(params.position)


def _places(server: Server, params: lsp.ReferenceParams | lsp.RenameParams) -> list[lsp.Location]:
    """The uses of the name at a position, in open documents and their imports."""
    key = server.document(params.text_document.uri).key(params.position)
    if key is None:
        return []
    documents = [server.document(uri) for uri in server.texts]
    places = {  # several documents may import the same file
        (span.source.name, span.start): document.location(span)
        for document in documents
        for span in document.uses(key)
    }
    return list(places.values())


def _rename(server: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    """The edits that rename a name everywhere.

    Raises:
        JsonRpcInvalidParams: the new name is invalid or taken, or the name belongs to a library.
    """
    document = server.document(params.text_document.uri)
    touched = document.names.at(document.place(params.position))
    if touched is None:
        return None
    name = params.new_name.strip("`")
    written = name_text(name)
    read, _ = parse_expression(Source(params.new_name, written))
    if not isinstance(read, Name) or read.text != name:
        raise JsonRpcInvalidParams(f"`{params.new_name}` cannot be written as a name")
    if name in document.names.declared or name in document.names.goals:
        raise JsonRpcInvalidParams(f"there is a `{name}` already")
    if not os.path.isabs(touched[1].span.source.name):
        raise JsonRpcInvalidParams(f"`{touched[1].text}` is a name of a library")
    edits: dict[str, list[lsp.TextEdit]] = {}
    for place in _places(server, params):
        edits.setdefault(place.uri, []).append(lsp.TextEdit(place.range, written))
    return lsp.WorkspaceEdit(edits)


def _symbols(server: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    return list(server.document(params.text_document.uri).symbols())


def _fixes(server: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
    return list(server.document(params.text_document.uri).fixes(params.range))


def _completion(server: Server, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
    uri = params.text_document.uri
    text = server.texts[uri]
    offset = text.offset(params.position)
    place = Span(Source(uri, text.code), offset, offset)
    word, completions = proposals(server.latest(uri).names, place)
    where = text.range(word.start, word.end)
    return [
        lsp.CompletionItem(
            proposal,
            kind=_KINDS[kind],
            documentation=meanings().get(proposal.removesuffix("(")) if kind != "name" else None,
            text_edit=lsp.TextEdit(where, proposal),
        )
        for proposal, kind in completions.items()
    ]


def _format(server: Server, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
    text = server.texts[params.text_document.uri]
    try:
        laid_out = format_text(text.code)
    except SpecError:
        return []  # the editor shows the errors already
    if "\r\n" in text.raw:
        laid_out = laid_out.replace("\n", "\r\n")
    return [lsp.TextEdit(text.range(0, len(text.raw)), laid_out)] if laid_out != text.raw else []


_FEATURES: dict[str, tuple[Callable[..., Any], Any]] = {
    lsp.TEXT_DOCUMENT_DID_OPEN: (_opened, None),
    lsp.TEXT_DOCUMENT_DID_CHANGE: (_changed, None),
    lsp.TEXT_DOCUMENT_DID_SAVE: (_saved, None),
    lsp.TEXT_DOCUMENT_DID_CLOSE: (_closed, None),
    lsp.TEXT_DOCUMENT_HOVER: (_hover, None),
    lsp.TEXT_DOCUMENT_DEFINITION: (_definition, None),
    lsp.TEXT_DOCUMENT_REFERENCES: (_places, None),
    lsp.TEXT_DOCUMENT_RENAME: (_rename, None),
    lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_symbols, None),
    lsp.TEXT_DOCUMENT_CODE_ACTION: (_fixes, lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix])),
    lsp.TEXT_DOCUMENT_COMPLETION: (_completion, lsp.CompletionOptions(["."])),
    lsp.TEXT_DOCUMENT_FORMATTING: (_format, None),
}
