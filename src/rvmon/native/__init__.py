"""The native core as it was built with the package, from the C in `rvmon/core`.

Raises:
    CoreError: the core is not built, or was built from other sources than those that lie here.
"""

from __future__ import annotations

from rvmon.errors import CoreError
from rvmon.native.sources import FOLDER, source_hash

_MEND = "run `pip install -e .` (or `make core`) in the clone of rvmon"

try:
    import rvmon.native._core as _core
except ModuleNotFoundError as error:
    if error.name != "rvmon.native._core":
        raise
    raise CoreError(f"the native core is not built ({FOLDER} has none): {_MEND}") from None

if _core.source_hash != (source_hash() or _core.source_hash):
    raise CoreError(f"the native core is older than its sources in {FOLDER}: {_MEND}")

Monitor = _core.Monitor
Record = _core.Record
memory_of = _core.memory_of
