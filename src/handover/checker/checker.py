"""Bus messages go to a monitor of a specification while the simulation runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rvmon.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdict.report import Report


class Checker:
    """Judges one test after the other: `begin`, `observe` each sample, `finish`.

    Args:
        spec: what to judge by; names on the bus that it does not declare are passed over.
    """

    def __init__(self, spec: Spec) -> None:
        self._spec = spec
        self._names = frozenset((*spec.checked.signals, *spec.checked.events))
        self._monitor: Monitor = spec.monitor()

    def begin(self) -> None:
        """Forget the last test."""
        self._monitor.reset()

    def observe(self, t_ns: int, values: Mapping[str, bool | float | None]) -> None:
        """Take one whole sample of the bus."""
        known = {name: value for name, value in values.items() if name in self._names}
        if known:
            self._monitor.step_ns(t_ns, known)

    def finish(self, end_ns: int) -> Report:
        """The verdicts on a test that was observed up to `end_ns`."""
        return self._monitor.finish_ns(end_ns)
