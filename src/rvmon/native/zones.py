"""The search through zones as it was built with the package, from the C in `rvmon/timed/native`.

Raises:
    CoreError: it is not built, or was built from other sources than those that lie here.
"""

from __future__ import annotations

from rvmon.errors import CoreError
from rvmon.native.sources import ZONES_FOLDER, source_hash

_MEND = "run `pip install -e .` (or `make core`) in the clone of rvmon"

try:
    import rvmon.native._zones as _zones
except ModuleNotFoundError as error:
    if error.name != "rvmon.native._zones":
        raise
    raise CoreError(f"the search of models is not built ({ZONES_FOLDER}): {_MEND}") from None

if _zones.source_hash != (source_hash(ZONES_FOLDER) or _zones.source_hash):
    raise CoreError(f"the search of models is older than its sources in {ZONES_FOLDER}: {_MEND}")

search = _zones.search
