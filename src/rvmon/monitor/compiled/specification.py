"""A specification of which requirements are compiled when they are first asked for."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.spec.checked.specification import CheckedSpec


class CompiledSpec:
    """A specification from which any number of monitors can be built.

    Attributes:
        checked: as checked.
        is_kept: whether what is dear to make of it is kept in the user's cache folder.
        forms: what was made for its monitors, by what it depends on.
    """

    def __init__(self, checked: CheckedSpec, *, is_kept: bool = False) -> None:
        self.checked = checked
        self.is_kept = is_kept
        self.forms: dict[object, object] = {}

    @cached_property
    def requirements(self) -> Mapping[str, CompiledRequirement]:
        """The compiled requirements by id.

        Raises:
            RvmonError: one cannot be monitored; which one and why is in the message.
        """
        # What compiles them is imported now: some recordings are judged without it.
        from rvmon.monitor.compiled.requirement import compiled_requirements

        return compiled_requirements(self.checked)

    def chosen(self, only: Collection[str] | None) -> Sequence[CompiledRequirement]:
        """Some requirements in the order of the file."""
        wanted = self.requirements.keys() if only is None else frozenset(only)
        return [one for name, one in self.requirements.items() if name in wanted]

    def __reduce__(self) -> tuple[Any, ...]:
        # Compiled again elsewhere: what was made here stays here.
        again = partial(CompiledSpec, is_kept=self.is_kept)
        return again, (self.checked,)


def compile_spec(checked: CheckedSpec) -> CompiledSpec:
    """Compile a specification, once for all its monitors.

    Args:
        checked: as checked.

    Raises:
        RvmonError: a requirement cannot be monitored; which one and why is in the message.
    """
    compiled = CompiledSpec(checked)
    _ = compiled.requirements
    return compiled
