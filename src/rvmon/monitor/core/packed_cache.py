"""Packed plans of before, from the user's cache folder: data, of which nothing is executed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rvmon.cache import cache_folder, file_stamps, keep, read_kept
from rvmon.spec.checked.plain_data import told_apart
from rvmon.spec.checked.specification import CheckedSpec

_HERE = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Kept:
    """What requirements are compiled and planned for.

    Attributes:
        data: the packed plan.
        single: events of which only one payload can be judged at one instant.
        readers: by name that is read, the ids of the requirements that do.
    """

    data: bytes
    single: frozenset[str] = frozenset()
    readers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class Place:
    """Where the packed plan of some requirements is kept, if anywhere.

    It is keyed by all that it depends on: what was checked of the specification, the requirements,
    and the files of rvmon by size and time. The key stands in the file, too: one that was renamed
    is none of this place.

    Args:
        spec: the specification.
        ids: of the requirements.
        measured: whether attempts are measured as well.
    """

    def __init__(self, spec: CheckedSpec, ids: tuple[str, ...], *, measured: bool) -> None:
        folder = cache_folder()
        if folder is None:
            self._path = None
            return
        how = (ids, measured)
        content = json.dumps([*file_stamps(str(_HERE)), told_apart(spec), *how])
        self._key = hashlib.sha256(content.encode()).hexdigest()
        self._path = folder / f"plan-{self._key}.bin"

    def read(self) -> Kept | None:
        """What is kept; `None` if that is nothing, or damaged. The core has to check the plan."""
        body = None if self._path is None else read_kept(self._path)
        if body is None:
            return None
        try:
            key, names, data = body.split(b"\n", 2)
            single, readers = json.loads(names)
            found = Kept(data, frozenset(single), {n: tuple(ids) for n, ids in readers.items()})
        except (ValueError, TypeError, AttributeError, RecursionError):
            return None
        return found if key == self._key.encode() else None

    def write(self, made: Kept) -> None:
        """Keep a plan; if that fails, never mind."""
        if self._path is not None:
            names = json.dumps([sorted(made.single), made.readers])
            keep(self._path, b"\n".join([self._key.encode(), names.encode(), made.data]))
