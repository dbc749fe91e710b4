"""The protocol below the server: messages that are none are answered, or skipped."""

from __future__ import annotations

import logging
from collections.abc import Generator
from typing import Any

from lsprotocol import types as lsp
from pygls.protocol import LanguageServerProtocol, lsp_method
from pygls.protocol.json_rpc import JsonRPCNotification, JsonRPCRequestMessage

_log = logging.getLogger(__name__)

UNREADABLE = (ValueError, RecursionError)
"""What is raised where a message is no JSON."""


class Protocol(LanguageServerProtocol):
    """Looks at messages before anything is done; leaves edits to us: see `Text`."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        for name in ("pygls.io_", "pygls.server"):
            logging.getLogger(name).addFilter(_in_a_line)

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(
        self, params: lsp.DidChangeTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Hand the edit on as it came."""
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    def structure_message(self, data: dict[str, Any]) -> Any:
        """An object of a message as it is: `handle_message` looks at the whole."""
        return data

    def handle_message(self, message: Any) -> None:
        """Do what a message asks for; a request that is wrong is refused, all else skipped."""
        if not isinstance(message, dict):
            return self.refuse(None, lsp.ErrorCodes.InvalidRequest, "it is no object")
        id_ = message.get("id")
        if isinstance(id_, bool) or not isinstance(id_, int | str | None):
            return self.refuse(None, lsp.ErrorCodes.InvalidRequest, "`id` is no number or text")
        method = message.get("method")
        if message.get("jsonrpc") != self.VERSION:
            return self.refuse(id_, lsp.ErrorCodes.InvalidRequest, "it is not of JSON-RPC 2.0")
        if method is None and id_ is not None and ("result" in message or "error" in message):
            return self._take_answer(message)
        if not isinstance(method, str):
            return self.refuse(id_, lsp.ErrorCodes.InvalidRequest, "`method` is no text")
        other = JsonRPCNotification if id_ is None else JsonRPCRequestMessage
        try:
            made = self._converter.structure(
                {"params": None, **message}, self.get_message_type(method) or other
            )
        except Exception:  # noqa: BLE001 - of many kinds
            return self._refuse_unless_asked(id_, f"`{method}`: `params` are not of its form")
        document = getattr(getattr(made, "params", None), "text_document", None)
        uri = getattr(document, "uri", None)
        known = getattr(self._server, "texts", {})
        if uri and method != lsp.TEXT_DOCUMENT_DID_OPEN and uri not in known:
            return self._refuse_unless_asked(id_, f"`{method}`: `{uri}` is not open")
        super().handle_message(made)
        return None

    def refuse(self, id_: int | str | None, code: lsp.ErrorCodes, why: str) -> None:
        """Answer that a message cannot be taken.

        Args:
            id_: of the request; `None`: there is none to be read.
            code: of the error.
            why: in words.
        """
        _log.warning("a message is refused: %s", why)
        error = {"code": code.value, "message": why}
        self._send_data({"jsonrpc": self.VERSION, "id": id_, "error": error})

    def _refuse_unless_asked(self, id_: int | str | None, why: str) -> None:
        """Refuse a request; nobody waits for the answer of a notification."""
        if id_ is None:
            _log.warning("a message is skipped: %s", why)
        else:
            self.refuse(id_, lsp.ErrorCodes.InvalidParams, why)

    def _take_answer(self, message: dict[str, Any]) -> None:
        try:
            made = super().structure_message(message)
        except Exception:  # noqa: BLE001 - of many kinds
            _log.warning("an answer is skipped: it is not of its form")
        else:
            super().handle_message(made)


def _in_a_line(record: logging.LogRecord) -> bool:
    """Let a log say what is no JSON without the way through the program."""
    if record.exc_info and isinstance(record.exc_info[1], UNREADABLE):
        record.msg, record.exc_info = f"{record.msg}: {record.exc_info[1]}", None
    return True
