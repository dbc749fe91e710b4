"""The reader of CSV text, from the C in `rvmon/readers/native`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rvmon.native.extension import extension
from rvmon.native.sources import CSV_FOLDER

if TYPE_CHECKING:
    import rvmon.native._csv as _csv

    read = _csv.read
else:
    read = extension("_csv", CSV_FOLDER, "the reader of CSV").read

__all__ = ["read"]
