"""A cache of compiled specifications, in the user's cache folder."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.errors import RvmonError
from rvmon.files import cache_folder, keep, read_kept, this_rvmon
from rvmon.language.checked.serialise import from_plain, to_plain
from rvmon.language.checked.specification import CheckedSpec
from rvmon.texts import text_of_file, tree_of

if TYPE_CHECKING:
    from rvmon.diagnostics import Diagnostic

    Compiled = tuple[CheckedSpec, tuple[Diagnostic, ...]]


def compile_cached(
    text: str,
    *,
    name: str = "<string>",
    constants: Mapping[str, str] | None = None,
    directory: Path | None = None,
) -> Compiled:
    """Compile a specification, or load the result from the cache if it was compiled before.

    Arguments and result are those of `rvmon.language.compile.compile_text`.

    An entry is keyed by text, name, constants, folder, and the sizes and times of rvmon's own
    files. It also holds the texts of all imported files, and is used only while these files may
    still be imported and have the same text.

    Raises:
        RvmonError: the text, or the value of a constant, is not a string.
        SpecError: the text has errors, as in `compile_text`.
    """
    if not isinstance(text, str):
        raise RvmonError(f"expected the text of a specification, found {type(text).__name__}")
    for constant, value in (constants or {}).items():
        if not isinstance(value, str):
            raise RvmonError(
                f"const={{{constant!r}: {value!r}}}: expected a text of the language, such as '2 s'"
            )
    folder = cache_folder()
    imported: dict[str, str] = {}

    def read(file: Path) -> str:
        imported[str(file)] = text_of_file(file)
        return imported[str(file)]

    path = None
    if folder is not None:
        about = name, text, sorted((constants or {}).items()), str(directory or "")
        content = json.dumps([this_rvmon(), *about])
        path = folder / f"spec-{hashlib.sha256(content.encode()).hexdigest()}.json"
        if (known := _read(path, directory or Path())) is not None:
            return known
    from rvmon.language.compile import compile_text

    made = compile_text(text, name=name, constants=constants, directory=directory, read=read)
    if path is not None:
        keep(path, json.dumps([imported, to_plain(made)], separators=(",", ":")).encode())
    return made


def _read(path: Path, directory: Path) -> Compiled | None:
    body = read_kept(path)
    if body is None:
        return None
    try:
        imported, data = json.loads(body)
        if imported:
            tree = tree_of(directory)
            for file, text in imported.items():
                # Which files may be imported depends on the project folder and on
                # RVMON_ALLOW_IMPORTS, and both may have changed.
                if not tree.holds(Path(file)) or text_of_file(file) != text:
                    return None
        spec, warnings = from_plain(data)
    # A cached file may be truncated or forged; the specification is then compiled again.
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return None
    return (spec, warnings) if isinstance(spec, CheckedSpec) else None
