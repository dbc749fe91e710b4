"""Online monitors: a specification judged sample by sample."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.compiled.specification import CompiledSpec, compile_spec
    from rvmon.monitor.core.monitor import Monitor, build_monitor

__all__ = ["CompiledRequirement", "CompiledSpec", "Monitor", "build_monitor", "compile_spec"]

# Recordings in columns are judged without a monitor: a name is imported when it is asked for.
_HOMES = {
    "CompiledRequirement": "rvmon.monitor.compiled.requirement",
    "CompiledSpec": "rvmon.monitor.compiled.specification",
    "Monitor": "rvmon.monitor.core.monitor",
    "build_monitor": "rvmon.monitor.core.monitor",
    "compile_spec": "rvmon.monitor.compiled.specification",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'rvmon.monitor' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
