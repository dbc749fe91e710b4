"""Online monitors: a specification judged sample by sample."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rvmon.monitor.compile import CompiledRequirement
    from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
    from rvmon.monitor.monitor import Monitor, build_monitor

__all__ = ["CompiledRequirement", "CompiledSpec", "Monitor", "build_monitor", "compile_spec"]

# Names are imported on first use: judging recordings in columns needs none of these modules.
_HOMES = {
    "CompiledRequirement": "rvmon.monitor.compile",
    "CompiledSpec": "rvmon.monitor.compiled_spec",
    "Monitor": "rvmon.monitor.monitor",
    "build_monitor": "rvmon.monitor.monitor",
    "compile_spec": "rvmon.monitor.compiled_spec",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'rvmon.monitor' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
