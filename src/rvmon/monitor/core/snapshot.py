"""A run of the core as a snapshot, and back: its bytes as text, beside what Python holds of it."""

from __future__ import annotations

import hashlib
from base64 import b64decode, b64encode
from collections.abc import Mapping
from typing import Any

from rvmon import native
from rvmon.errors import SnapshotError
from rvmon.monitor.core.planned import PlannedCore
from rvmon.monitor.online.freeze import Freezer, Thawer
from rvmon.monitor.online.options import Options
from rvmon.monitor.online.snapshot import heading, sealed


def written(options: Options, planned: PlannedCore, run: native.Monitor, beside: object) -> bytes:
    """The bytes of a run.

    Args:
        options: what its monitor was asked for.
        planned: the plan that it judges by.
        run: of the core.
        beside: what Python holds, by its `STATE`.
    """
    document = heading(options, planned.packed.ids)
    document["plan"] = _digest(planned)
    document["core"] = b64encode(run.save()).decode("ascii")
    document["state"] = Freezer({}).freeze(beside)
    return sealed(document)


def put_back(
    document: Mapping[str, Any], planned: PlannedCore, run: native.Monitor, beside: object
) -> None:
    """Give a run that was just begun the state that a snapshot holds.

    Raises:
        SnapshotError: the requirements were judged by another plan, or what is there is no run.
    """
    if document["plan"] != _digest(planned):
        raise SnapshotError("the snapshot was made with another plan: was rvmon changed?")
    if not run.load(b64decode(document["core"], validate=True)):
        raise SnapshotError("the snapshot is damaged: what it holds is no run of its plan")
    Thawer({}).into(beside, document["state"])


def _digest(planned: PlannedCore) -> str:
    return hashlib.sha256(planned.packed.data).hexdigest()
