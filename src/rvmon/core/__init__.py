"""The native core: C that is built with the package, and found here as `_core`.

Raises:
    CoreError: the core is not built, or was built from other sources than those that lie here.
"""

from __future__ import annotations

from rvmon.core.sources import FOLDER, source_hash
from rvmon.errors import CoreError

_MEND = "run `pip install -e .` (or `make core`) in the clone of rvmon"

try:
    import rvmon.core._core as _core
except ModuleNotFoundError as error:
    if error.name != "rvmon.core._core":
        raise
    raise CoreError(f"the native core is not built ({FOLDER} has none): {_MEND}") from None

if _core.source_hash != (source_hash() or _core.source_hash):
    raise CoreError(f"the native core is older than its sources in {FOLDER}: {_MEND}")
