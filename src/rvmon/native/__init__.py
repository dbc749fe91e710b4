"""Loads the C extensions, each built with the package from its own sources; the core on import.

Raises:
    CoreError: the core is not built, or was built from sources other than those found here.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from rvmon.errors import CoreError
from rvmon.native.sources import FOLDER, source_hash

_MEND = "run `pip install -e .` (or `make core`) in the clone of rvmon"


def extension(name: str, folder: str, called: str) -> ModuleType:
    """Import an extension.

    Args:
        name: the name of its module in `rvmon.native`.
        folder: the folder of its sources.
        called: its name in messages.

    Raises:
        CoreError: it is not built, or was built from sources other than those found there.
    """
    module = f"rvmon.native.{name}"
    try:
        imported = import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module:
            raise
        raise CoreError(f"{called} is not built ({folder}): {_MEND}") from None
    if imported.source_hash != (source_hash(folder) or imported.source_hash):
        raise CoreError(f"{called} is older than its sources in {folder}: {_MEND}")
    return imported


if TYPE_CHECKING:
    import rvmon.native._core as _core
else:
    _core = extension("_core", FOLDER, "the native core")

Monitor = _core.Monitor
Record = _core.Record
Figure = _core.Figure
Bounds = _core.Bounds
memory_of = _core.memory_of
