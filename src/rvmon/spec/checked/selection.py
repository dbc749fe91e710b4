"""What a caller asks for by name, all of which there is."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.diagnostics.nearest import did_you_mean
from rvmon.errors import UnknownNameError
from rvmon.spec.checked.specification import CheckedSpec


def requirements_asked(spec: CheckedSpec, only: Iterable[str] | None) -> tuple[str, ...] | None:
    """Ids of requirements; `None`: all.

    Raises:
        UnknownNameError: there is no such requirement.
    """
    chosen = None if only is None else tuple(only)
    for name in chosen or ():
        if name not in spec.requirements:
            known = ", ".join(spec.requirements) or "none"
            raise UnknownNameError(f"no requirement `{name}`: there are {known}")
    return chosen


def sources_asked(spec: CheckedSpec, names: Iterable[str] | None) -> frozenset[str] | None:
    """Names of signals and events; `None`: all.

    Raises:
        UnknownNameError: there is no such signal or event.
    """
    given = None if names is None else frozenset(names)
    declared = [*spec.signals, *spec.events]
    for name in sorted((given or frozenset()).difference(declared)):
        meant = did_you_mean(name, declared, f"there are {', '.join(declared)}")
        raise UnknownNameError(f"no signal or event named `{name}`: {meant}")
    return given
