"""Specifications that were compiled before, from the user's cache folder."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.files import cache_folder, file_stamps, keep, read_kept
from rvmon.spec.checked.plain_data import from_plain, to_plain
from rvmon.spec.checked.specification import CheckedSpec

if TYPE_CHECKING:
    from rvmon.diagnostics import Diagnostic

    Compiled = tuple[CheckedSpec, tuple[Diagnostic, ...]]

_HERE = Path(__file__).parent


def compile_cached(
    text: str,
    *,
    name: str = "<string>",
    constants: Mapping[str, str] | None = None,
    directory: Path | None = None,
) -> Compiled:
    """As `rvmon.spec.compile.compile_text`, which is asked once for each text.

    What is kept is keyed by all that it depends on: text, name, constants, and the compiler's files
    by size and time. A text that imports others is compiled each time.
    """
    folder = None if "import" in text else cache_folder()
    if folder is None:
        return _compiled(text, name, constants, directory)
    content = json.dumps([*file_stamps(str(_HERE)), name, text, sorted((constants or {}).items())])
    path = folder / f"spec-{hashlib.sha256(content.encode()).hexdigest()}.json"
    found = _read(path)
    if found is None:
        found = _compiled(text, name, constants, directory)
        keep(path, json.dumps(to_plain(found), separators=(",", ":")).encode())
    return found


def _compiled(
    text: str, name: str, constants: Mapping[str, str] | None, directory: Path | None
) -> Compiled:
    from rvmon.spec.compile import compile_text

    return compile_text(text, name=name, constants=constants, directory=directory)


def _read(path: Path) -> Compiled | None:
    body = read_kept(path)
    if body is None:
        return None
    try:
        spec, warnings = from_plain(json.loads(body))
    except (ValueError, LookupError, TypeError, RecursionError):
        return None
    return (spec, warnings) if isinstance(spec, CheckedSpec) else None
