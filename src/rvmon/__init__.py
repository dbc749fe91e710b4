"""Judge temporal requirements on event streams and recordings of robots.

>>> import rvmon
>>> spec = rvmon.loads('''
... spec door "A door"
... signal closed : bool input
... event knock input
... requirement D1 "Knocking opens the door"
...   upon knock
...   then within 2 s not closed
... ''')
>>> monitor = spec.monitor()
>>> [str(attempt) for attempt in monitor.step(0.0, {"closed": True, "knock": True})]
[]
>>> monitor.finish(3.0).verdicts["D1"].value
'F'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rvmon.version import __version__

if TYPE_CHECKING:
    from rvmon.diagnostics import Diagnostic
    from rvmon.errors import RvmonError, SpecError, TraceError
    from rvmon.language.checked.specification import Requirement
    from rvmon.monitor.monitor import Monitor
    from rvmon.session import Spec, load, loads
    from rvmon.trace.sample import Sample
    from rvmon.verdicts import Verdict
    from rvmon.verdicts.attempt import Attempt
    from rvmon.verdicts.report import Report

__all__ = [
    "Attempt",
    "Diagnostic",
    "Monitor",
    "Report",
    "Requirement",
    "RvmonError",
    "Sample",
    "Spec",
    "SpecError",
    "TraceError",
    "Verdict",
    "__version__",
    "load",
    "loads",
]

# `import rvmon` stays light: a name is imported at its first use.
_HOMES = {
    "Attempt": "rvmon.session",
    "Diagnostic": "rvmon.diagnostics",
    "Monitor": "rvmon.monitor.monitor",
    "Report": "rvmon.session",
    "Requirement": "rvmon.language.checked.specification",
    "Sample": "rvmon.trace.sample",
    "Spec": "rvmon.session",
    "Verdict": "rvmon.verdicts",
    "load": "rvmon.session",
    "loads": "rvmon.session",
    **{name: "rvmon.errors" for name in __all__ if name.endswith("Error")},
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'rvmon' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
