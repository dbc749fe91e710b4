"""Online monitors: a specification judged sample by sample."""

from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec, compile_spec
from rvmon.monitor.monitor import Monitor, build_monitor

__all__ = ["CompiledRequirement", "CompiledSpec", "Monitor", "build_monitor", "compile_spec"]
