"""A specification for the core: requirements compiled on first use, packed plans cached on disk.

Cached plans are plain data; nothing in them is executed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from rvmon.files import cache_folder, keep, read_kept, this_rvmon
from rvmon.language.checked.serialise import identity_text
from rvmon.language.checked.specification import CheckedSpec

if TYPE_CHECKING:
    from rvmon.monitor.compile import CompiledRequirement


class CompiledSpec:
    """A compiled specification, from which any number of monitors can be built."""

    def __init__(
        self,
        checked: CheckedSpec,
        *,
        is_kept: bool = False,
        origin: CompiledSpec | None = None,
    ) -> None:
        self.checked = checked
        self.is_kept = is_kept  # whether packed plans are cached in the user's cache folder
        # the specification it was derived from; coverage does so, always in the same way
        self._origin = origin
        # objects made from it so far, such as packed plans, by the options they depend on
        self.forms: dict[object, object] = {}

    @cached_property
    def identity(self) -> str:
        """A text that is the same for specifications that differ only in source positions."""
        if self._origin is None:
            return identity_text(self.checked)
        return f"derived from {self._origin.identity}"

    @cached_property
    def requirements(self) -> Mapping[str, CompiledRequirement]:
        """The compiled requirements by id.

        Raises:
            RvmonError: one cannot be monitored; the message says which one and why.
        """
        # Imported on use: with a cached plan, recordings are judged without the compiler.
        from rvmon.monitor.compile import compiled_requirements

        return compiled_requirements(self.checked)

    def chosen(self, only: Collection[str] | None) -> Sequence[CompiledRequirement]:
        """The requirements with these ids (`None`: all), in the order of the file."""
        wanted = self.requirements.keys() if only is None else frozenset(only)
        return [requirement for name, requirement in self.requirements.items() if name in wanted]

    def __reduce__(self) -> tuple[Any, ...]:
        # Only the checked specification is pickled; the other process compiles it again.
        again = partial(CompiledSpec, is_kept=self.is_kept, origin=self._origin)
        return again, (self.checked,)


def compile_spec(checked: CheckedSpec) -> CompiledSpec:
    """Compile a specification, once for all its monitors.

    Raises:
        RvmonError: a requirement cannot be monitored; the message says which one and why.
    """
    compiled = CompiledSpec(checked)
    _ = compiled.requirements
    return compiled


class Kept(Struct, frozen=True):
    """A packed plan as it is cached; for the fields see `rvmon.monitor.packed_plan.PlannedCore`."""

    data: bytes
    single: frozenset[str] = frozenset()
    readers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class Place:
    """The cache entry of the packed plan of some requirements.

    The key is a hash of everything the plan depends on: the checked specification, `how` it is
    planned, and the size and time of rvmon's files. It is also stored in the file, so that a
    renamed file is not taken for the entry.
    """

    def __init__(self, spec: CompiledSpec, *how: object) -> None:
        folder = cache_folder()
        if folder is None:
            self._path = None
            return
        content = json.dumps([this_rvmon(), spec.identity, *how])
        self._key = hashlib.sha256(content.encode()).hexdigest()
        self._path = folder / f"plan-{self._key}.bin"

    def read(self) -> Kept | None:
        """Read the entry; `None` if there is none or it is damaged. The core checks the plan."""
        body = None if self._path is None else read_kept(self._path)
        if body is None:
            return None
        try:
            key, names, data = body.split(b"\n", 2)
            single, readers = json.loads(names)
            kept = Kept(data, frozenset(single), {n: tuple(ids) for n, ids in readers.items()})
        except (ValueError, TypeError, AttributeError, RecursionError):
            return None
        return kept if key == self._key.encode() else None

    def write(self, kept: Kept) -> None:
        """Write the entry; a failure is ignored, as the plan can be made again."""
        if self._path is not None:
            names = json.dumps([sorted(kept.single), kept.readers])
            keep(self._path, b"\n".join([self._key.encode(), names.encode(), kept.data]))
