"""The file of mutants that are said to be equivalent: each with the change, and the argument."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path

from rvmon.cdv.mutation.mutant import Mutant
from rvmon.diagnostics.text_file import text_of_file
from rvmon.errors import RvmonError

_KEYS = {"change", "because"}


def equivalents(path: str | Path, mutants: Iterable[Mutant]) -> dict[str, str]:
    """Read the file: TOML, a table for each mutant, named by its identity.

    Args:
        path: of the file.
        mutants: that there are.

    Returns:
        The argument for each, by identity.

    Raises:
        RvmonError: it cannot be read, names no mutant, or one that is another change by now.
    """
    try:
        found = tomllib.loads(text_of_file(path))
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise RvmonError(f"{path}: not TOML: {error}") from None
    known = {one.identity: one for one in mutants}
    return {name: _argument(path, name, entry, known) for name, entry in found.items()}


def _argument(path: str | Path, name: str, entry: object, known: Mapping[str, Mutant]) -> str:
    if not isinstance(entry, dict) or entry.keys() != _KEYS:
        raise RvmonError(f"{path}: `{name}` is to have `change` and `because`, and nothing else")
    if name not in known:
        raise RvmonError(f"{path}: no mutant `{name}`: --list lists them")
    change, because = entry["change"], entry["because"]
    if change != known[name].change:
        raise RvmonError(
            f"{path}: `{name}` is by now the change {known[name].change}: look whether it is "
            "equivalent, and correct `change`"
        )
    if not isinstance(because, str) or not because.strip():
        raise RvmonError(f"{path}: `{name}` needs an argument in `because`")
    return because
