"""Parsers whose tables were worked out before: kept in the user's cache folder, as JSON.

To work out the tables of a grammar takes ten times as long as to read them. The cache holds data
and no code; it is keyed by the grammar and by the version of the parser generator, so that it is
never out of date and can be deleted at any time. Whatever is wrong with it, the tables are worked
out anew. `RVMON_CACHE=off` switches it off.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import lark
from lark.grammar import Rule
from lark.lexer import TerminalDef

_FORMAT = 1


def parser_of(grammar: str, options: Mapping[str, Any]) -> lark.Lark:
    """The parser of a grammar.

    Args:
        grammar: its text.
        options: as `lark.Lark` takes them; no functions among them.
    """
    folder = cache_folder()
    if folder is None:
        return lark.Lark(grammar, **options)
    said = json.dumps([_FORMAT, lark.__version__, grammar, dict(options)], sort_keys=True)
    path = folder / f"grammar-{hashlib.sha256(said.encode()).hexdigest()}.json"
    known = _read(path)
    if known is not None:
        return known
    made = lark.Lark(grammar, **options)
    _write(path, made)
    return made


def cache_folder() -> Path | None:
    """Where tables are kept; `None` if nowhere: switched off, or others could write there."""
    if os.environ.get("RVMON_CACHE", "").lower() in ("off", "0", "no"):
        return None
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        folder = (base if base.is_absolute() else Path.home() / ".cache") / "rvmon"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return folder if _is_ours(folder) else None
    except (OSError, RuntimeError):
        return None


def _is_ours(path: Path) -> bool:
    """Whether nobody else can write there, as far as the system can tell."""
    if not hasattr(os, "getuid"):
        return True
    found = path.stat()
    return found.st_uid == os.getuid() and not found.st_mode & 0o022


def _read(path: Path) -> lark.Lark | None:
    try:
        if not _is_ours(path):
            return None
        checksum, _, body = path.read_bytes().partition(b"\n")
        if hashlib.sha256(body).hexdigest().encode() != checksum:
            return None
        known: lark.Lark = lark.Lark.load(_thawed(json.loads(body)))
        known.ignore_tokens = list(known.lexer_conf.ignore)
    except Exception:  # noqa: BLE001 - whatever is wrong with a cache, it can be done without
        return None
    return known


def _write(path: Path, made: lark.Lark) -> None:
    """Put the tables where others see them whole or not at all; if that fails, never mind."""
    data, memo = made.memo_serialize([TerminalDef, Rule])
    body = json.dumps(_frozen({"data": data, "memo": memo}), separators=(",", ":")).encode()
    name = ""
    with suppress(OSError):
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            name = file.name
            file.write(hashlib.sha256(body).hexdigest().encode() + b"\n" + body)
        Path(name).replace(path)
        return
    if name:
        Path(name).unlink(missing_ok=True)


def _frozen(value: Any) -> Any:
    """JSON has no numbers as keys: such mappings become lists of pairs."""
    if isinstance(value, dict):
        if all(isinstance(key, str) for key in value):
            return {key: _frozen(one) for key, one in value.items()}
        return {"": [[key, _frozen(one)] for key, one in value.items()]}
    if isinstance(value, list | tuple | set | frozenset):
        return [_frozen(one) for one in value]
    return value


def _thawed(value: Any) -> Any:
    if isinstance(value, dict):
        if list(value) == [""]:
            return {key: _thawed(one) for key, one in value[""]}
        return {key: _thawed(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_thawed(one) for one in value]
    return value
