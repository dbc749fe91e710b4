"""`rvmon lsp` as an editor uses it: a process that speaks the protocol."""

import asyncio
import signal
import subprocess
import sys
from contextlib import asynccontextmanager

import pytest
import pytest_lsp
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

pytestmark = pytest.mark.process

COMMAND = (sys.executable, "-m", "rvmon", "lsp", "--stdio")
MAIN = """spec main "😋"\r
import "signals.rv"\r
requirement R "😋" upon ask then within 3 s anser\r
"""
LAID_OUT = """spec door "😋"
signal d : real [m]

requirement R
  always d < 5 cm
"""


class Editor:
    """An editor with documents in a folder."""

    def __init__(self, client, folder):
        self.client = client
        self.folder = folder
        self._version = 0

    def document(self, name):
        """The identifier of a document in requests."""
        return lsp.TextDocumentIdentifier((self.folder / name).as_uri())

    async def until(self, seen):
        """Poll until findings are as expected: a notification may precede the waiting."""
        async with asyncio.timeout(60):
            while not seen():
                await asyncio.sleep(0.01)

    async def open(self, name, text):
        """Open a document and return its findings as pairs of code and place."""
        item = lsp.TextDocumentItem(self.document(name).uri, "rv", 1, text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        await self.until(lambda: item.uri in self.client.diagnostics)
        return self.found(name)

    def type(self, name, line, start, end, text):
        """Replace some columns of a line."""
        self._version += 1
        where = lsp.Range(lsp.Position(line, start), lsp.Position(line, end))
        document = lsp.VersionedTextDocumentIdentifier(self._version, self.document(name).uri)
        change = lsp.TextDocumentContentChangePartial(where, text)
        self.client.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [change]))

    def ask(self, request, params):
        """Send a request about a document and await the answer."""
        return getattr(self.client, f"text_document_{request}_async")(params)

    def found(self, name):
        """The latest findings of a document."""
        found = self.client.diagnostics[self.document(name).uri]
        return [(one.code, str(one.range)) for one in found]


@asynccontextmanager
async def editor(folder, encodings=None):
    """An editor connected to the server, which is shut down at the end."""
    client = pytest_lsp.make_test_lsp_client()
    await client.start_io(*COMMAND)
    capabilities = pytest_lsp.client_capabilities("visual-studio-code")
    capabilities.general.position_encodings = encodings
    await client.initialize_session(lsp.InitializeParams(capabilities=capabilities))
    yield Editor(client, folder)
    await client.shutdown_session()
    assert client._server.returncode == 0
    assert not client.messages, "no error was shown"
    await client.stop()


def test_a_session_of_editing_answers_all_requests(tmp_path):
    async def session():
        async with editor(tmp_path) as of:
            assert await of.open("signals.rv", "event ask\n") == []
            assert await of.open("main.rv", MAIN) == [("RV012", "2:44-2:49")]
            document = of.document("main.rv")
            before = of.client.diagnostics[document.uri]
            of.type("signals.rv", 0, 9, 9, ", answer")
            await of.until(lambda: of.client.diagnostics[document.uri] is not before)
            at = lsp.Position(2, 45)
            here = lsp.CodeActionParams(document, lsp.Range(at, at), lsp.CodeActionContext([]))
            (fix,) = await of.ask("code_action", here)
            ((edit,),) = fix.edit.changes.values()
            assert (str(edit.range), edit.new_text) == ("2:44-2:49", "answer")
            for number, letter in enumerate("answer"):
                place = 44 + number
                of.type("main.rv", 2, place, place if number else 49, letter)
            await of.until(lambda: not of.found("main.rv"))
            shown = await of.ask("hover", lsp.HoverParams(document, lsp.Position(2, 12)))
            assert "within 3 s, answer occurs" in shown.contents.value
            declared = of.document("signals.rv").uri
            (place,) = await of.ask("definition", lsp.DefinitionParams(document, at))
            assert (place.uri, str(place.range)) == (declared, "0:11-0:17")
            everywhere = lsp.ReferenceParams(lsp.ReferenceContext(True), document, at)
            uses = await of.ask("references", everywhere)
            assert sorted(str(use.range) for use in uses) == ["0:11-0:17", "2:44-2:50"]
            changes = (await of.ask("rename", lsp.RenameParams(document, at, "for"))).changes
            for uri, where in ((declared, "0:11-0:17"), (document.uri, "2:44-2:50")):
                (edit,) = changes.pop(uri)
                assert (str(edit.range), edit.new_text) == (where, "`for`")
            assert not changes
            for name, why in (("ask", "there is a `ask` already"), ("a\nb", "cannot be written")):
                with pytest.raises(JsonRpcException, match=why):
                    await of.ask("rename", lsp.RenameParams(document, at, name))
            offered = await of.ask(
                "completion", lsp.CompletionParams(document, lsp.Position(2, 24))
            )
            assert "ask" in {item.label for item in offered if item.text_edit.range}
            outline = await of.ask("document_symbol", lsp.DocumentSymbolParams(document))
            assert [(symbol.name, symbol.detail) for symbol in outline] == [("R", "😋")]
            of.type("main.rv", 2, 0, 1, "")
            await of.until(lambda: of.found("main.rv"))
            of.client.text_document_did_close(lsp.DidCloseTextDocumentParams(document))
            await of.until(lambda: not of.found("main.rv"))

    asyncio.run(session())


def test_positions_in_utf8_formatting_and_saved_imports(tmp_path):
    async def session():
        async with editor(tmp_path, [lsp.PositionEncodingKind.Utf8]) as of:
            assert await of.open("a.rv", 'spec door "😋"  signal\r\n') == [("RV001", "0:18-0:24")]
            layout = lsp.DocumentFormattingParams(
                of.document("a.rv"), lsp.FormattingOptions(2, True)
            )
            assert not await of.ask("formatting", layout), "the text cannot be read"
            lines = LAID_OUT.split("\n", 1)[1].replace("\n\n", "\n").replace("  ", " ")
            of.type("a.rv", 0, 16, 24, "\r\n" + lines.replace("\n", "\r\n"))
            (edit,) = await of.ask("formatting", layout)
            assert edit.new_text == LAID_OUT.replace("\n", "\r\n")
            (tmp_path / "b.rv").write_text("event ask\n", encoding="utf-8")
            text = 'import "b.rv"\nrequirement R upon ask then within 3 s ask\n'
            assert await of.open("c.rv", text) == []
            (tmp_path / "b.rv").write_text("event asked\n", encoding="utf-8")
            saved = lsp.DidSaveTextDocumentParams(of.document("c.rv"))
            of.client.text_document_did_save(saved)
            await of.until(lambda: of.found("c.rv"))

    asyncio.run(session())


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT, None])
def test_the_server_ends_with_its_editor(ending):
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(COMMAND, **pipes) as server:  # noqa: S603 - ours
        body = b'{"jsonrpc":"2.0","id":1,"method":"shutdown"}'
        server.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        server.stdin.flush()
        assert server.stdout.readline().startswith(b"Content-Length"), "the server is up"
        if ending is None:
            server.stdin.close()
        else:
            server.send_signal(ending)
        assert server.wait(30) == (0 if ending is None else -ending)


def test_a_missing_pygls_is_reported_with_the_command_that_installs_it(monkeypatch, says):
    monkeypatch.setitem(sys.modules, "pygls.lsp.server", None)
    monkeypatch.delitem(sys.modules, "rvmon.cli.lsp.server", raising=False)
    assert "pip install 'rvmon[lsp]'" in says(2, "lsp").err
