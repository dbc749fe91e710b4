"""Where it stands in the cache what was compiled ahead: read by all who start, so it is light."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from rvmon.cache import cache_folder, file_stamps, is_whole, keep, read_kept
from rvmon.codegen.c_build import processor
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.snapshot import digest_of

BESIDE, MEASURING = "beside", "measuring"
"""What a file is for: to stand beside generated Python, or to measure robustness."""

_PACKAGE = Path(__file__).parents[2]


def note(
    use: str,
    path: Path,
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    taken: Sequence[CompiledRequirement],
) -> None:
    """Write down that a file was made.

    Args:
        use: what it is for.
        path: of the file, in the cache.
        compiled: the specification.
        chosen: the requirements that it was made for, from it.
        taken: those of them that it judges.
    """
    content = json.dumps([_maker(), path.name, _ids(taken)]).encode()
    keep(_place(use, path.parent, compiled, chosen), content)
    for key in (key_of(use, chosen), _key_of_note(use, chosen)):
        compiled.forms.pop(key, None)


def noted(
    use: str, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> tuple[Path, list[str]] | None:
    """The file that was made, and the ids of what it judges; `None`: none was, or no longer fits.

    Args:
        use: what it is for.
        compiled: the specification.
        chosen: the requirements, from it.
    """
    key = _key_of_note(use, chosen)
    if key not in compiled.forms:
        compiled.forms[key] = _read(use, compiled, chosen) if _has_gil() else None
    found = compiled.forms[key]
    return found if isinstance(found, tuple) else None


def key_of(use: str, chosen: Sequence[CompiledRequirement]) -> tuple[object, ...]:
    """What a specification has the library by that was made for some requirements."""
    return (use, *_ids(chosen))


def _key_of_note(use: str, chosen: Sequence[CompiledRequirement]) -> tuple[object, ...]:
    return ("noted", *key_of(use, chosen))


def _read(
    use: str, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> tuple[Path, list[str]] | None:
    folder = cache_folder()
    content = None if folder is None else read_kept(_place(use, folder, compiled, chosen))
    if folder is None or content is None:
        return None
    try:
        maker, name, ids = json.loads(content)
    except ValueError:
        return None
    path = folder / Path(name).name
    return (path, ids) if maker == _maker() and is_whole(path) else None


def _has_gil() -> bool:
    return bool(getattr(sys, "_is_gil_enabled", lambda: True)())


def _ids(chosen: Sequence[CompiledRequirement]) -> list[str]:
    return [one.requirement.id for one in chosen]


def _place(
    use: str, folder: Path, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> Path:
    """Of the note which file was made of some requirements."""
    key = (digest_of(compiled), _ids(chosen))
    return folder / f"{use}-{hashlib.sha256(repr(key).encode()).hexdigest()[:40]}.json"


@cache
def _maker() -> str:
    """What else a file depends on: this package, this Python, this processor."""
    key = (list(file_stamps(str(_PACKAGE))), sys.version, processor())
    return hashlib.sha256(repr(key).encode()).hexdigest()
