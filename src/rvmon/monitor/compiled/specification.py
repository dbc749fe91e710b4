"""A specification of which requirements are compiled when they are first asked for."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.spec.checked.specification import CheckedSpec


class CompiledSpec:
    """A specification from which any number of monitors can be built.

    Attributes:
        checked: as checked.
        forms: what was generated for its monitors, by what it depends on.
    """

    def __init__(self, checked: CheckedSpec) -> None:
        self.checked = checked
        self.forms: dict[object, object] = {}

    @cached_property
    def requirements(self) -> Mapping[str, CompiledRequirement]:
        """The compiled requirements by id.

        Raises:
            RvmonError: one is beyond all engines; which one and why is in the message.
        """
        # What compiles them is imported now: some recordings are judged without it.
        from rvmon.monitor.compiled.requirement import compiled_requirements

        return compiled_requirements(self.checked)

    def chosen(self, only: Collection[str] | None) -> Sequence[CompiledRequirement]:
        """Some requirements in the order of the file."""
        wanted = self.requirements.keys() if only is None else frozenset(only)
        return [one for name, one in self.requirements.items() if name in wanted]

    def __reduce__(self) -> tuple[Any, ...]:
        # Compiled again elsewhere: what was generated here, and tables in hand, stay here.
        return compile_spec, (self.checked,)


def compile_spec(checked: CheckedSpec) -> CompiledSpec:
    """Compile a specification, once for all its monitors.

    Raises:
        RvmonError: a requirement is beyond all engines; which one and why is in the message.
    """
    compiled = CompiledSpec(checked)
    _ = compiled.requirements
    return compiled
