"""Parsers whose tables were worked out before: kept in the user's cache folder, as JSON.

To work out the tables of a grammar takes ten times as long as to read them. They are keyed by the
grammar and by the version of the parser generator, so that they are never out of date.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import lark
from lark.grammar import Rule
from lark.lexer import TerminalDef

from rvmon.files import cache_folder, keep, read_kept

_FORMAT = 2


def parser_of(grammar: str, options: Mapping[str, Any]) -> lark.Lark:
    """The parser of a grammar; `options` as `lark.Lark` takes them, no functions among them."""
    folder = cache_folder()
    if folder is None:
        return lark.Lark(grammar, **options)
    content = json.dumps([_FORMAT, lark.__version__, grammar, dict(options)], sort_keys=True)
    path = folder / f"grammar-{hashlib.sha256(content.encode()).hexdigest()}.json"
    known = _read(path)
    if known is not None:
        return known
    parser = lark.Lark(grammar, **options)
    data, memo = parser.memo_serialize([TerminalDef, Rule])
    tables = {"data": data, "memo": memo}
    keep(path, json.dumps(tables, default=list, separators=(",", ":")).encode())
    return parser


def _read(path: Path) -> lark.Lark | None:
    body = read_kept(path)
    if body is None:
        return None
    try:
        known: lark.Lark = lark.Lark.load(json.loads(body, object_hook=_with_numbers))
        # Lark's `load` does not set it; tests read all terminals.
        known.ignore_tokens = list(known.lexer_conf.ignore)
    except Exception:  # noqa: BLE001 - whatever is wrong with a cache, it can be done without
        return None
    return known


def _with_numbers(tables: dict[str, Any]) -> dict[str | int, Any]:
    """JSON has no numbers as keys: those of lark, such as states, came as texts of digits."""
    return {int(key) if key.isdecimal() else key: value for key, value in tables.items()}
