"""Online monitors: a specification judged sample by sample."""

from rvmon.monitor.build import build_monitor
from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec, compile_spec
from rvmon.monitor.monitor import Monitor

__all__ = ["CompiledRequirement", "CompiledSpec", "Monitor", "build_monitor", "compile_spec"]
