"""The file of mutants that are declared equivalent: arguments, and the mutants each is for."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path

from rvmon.cdv.mutation.mutant import Mutant
from rvmon.diagnostics.text_file import text_of_file
from rvmon.errors import RvmonError


def equivalents(path: str | Path, mutants: Iterable[Mutant]) -> dict[str, str]:
    """Read the file: TOML, a table for each argument, with the changes by the mutants' identities.

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
    known = {one.identity: one.brief for one in mutants}
    arguments: dict[str, str] = {}
    for name, entry in found.items():
        match entry:
            case {"because": str() as because, "mutants": dict() as changes, **rest} if (
                because.strip() and not rest
            ):
                _refuse_others(path, changes, known)
                arguments |= dict.fromkeys(changes, because)
            case _:
                raise RvmonError(
                    f"{path}: `{name}` is to have an argument, `because`, and `mutants`: their "
                    "changes by their names, as --list shows them"
                )
    return arguments


def _refuse_others(
    path: str | Path, changes: Mapping[str, object], known: Mapping[str, str]
) -> None:
    for name, change in changes.items():
        if name not in known:
            raise RvmonError(f"{path}: no mutant `{name}`: --list lists them")
        if change != known[name]:
            raise RvmonError(
                f"{path}: `{name}` is by now another change, {known[name]}: look whether it is "
                "equivalent, and correct the entry"
            )
