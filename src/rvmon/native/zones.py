"""The search through zones, from the C in `rvmon/timed/native`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rvmon.native.extension import extension
from rvmon.native.sources import ZONES_FOLDER

if TYPE_CHECKING:
    import rvmon.native._zones as _zones

    search = _zones.search
else:
    search = extension("_zones", ZONES_FOLDER, "the search of models").search

__all__ = ["search"]
