"""A cache of parser tables, kept as JSON in the user's cache folder.

Computing the tables of a grammar takes ten times as long as loading them. The key is made of the
grammar, the options and the version of the parser generator, so an entry is never out of date.
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
    """The parser of a grammar; `options` are those of `lark.Lark`, without functions."""
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
        # Lark's `load` does not set `ignore_tokens`, which tests read.
        known.ignore_tokens = list(known.lexer_conf.ignore)
    except Exception:  # noqa: BLE001 - a broken cache entry, in whatever way, is recomputed
        return None
    return known


def _with_numbers(tables: dict[str, Any]) -> dict[str | int, Any]:
    """Turn keys of digits back into numbers, such as lark's states: JSON keys are texts."""
    return {int(key) if key.isdecimal() else key: value for key, value in tables.items()}
