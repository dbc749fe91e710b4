"""Messages and measurements of one instant become one sample."""

from __future__ import annotations

from collections.abc import Callable

SampleValue = bool | float | None
Sample = tuple[int, dict[str, SampleValue]]


class Recorder:
    """Collects samples in time order; a signal is kept only when it changes, an event always.

    Attributes:
        samples: the whole ones; the instant that is still going on is not among them.
    """

    def __init__(self, observer: Callable[[int, dict[str, SampleValue]], None] | None) -> None:
        self.samples: list[Sample] = []
        self._observer = observer
        self._t_ns = 0
        self._values: dict[str, SampleValue] = {}
        self._last: dict[str, SampleValue] = {}

    def event(self, t_ns: int, name: str) -> None:
        """Note that an event occurred."""
        self._at(t_ns)[name] = True

    def signal(self, t_ns: int, name: str, value: SampleValue) -> None:
        """Note a signal's value, if it is another than before."""
        if name not in self._last or self._last[name] != value:
            self.refresh(t_ns, name, value)

    def refresh(self, t_ns: int, name: str, value: SampleValue) -> None:
        """Note a signal's value also if it is as before: the source is alive."""
        self._last[name] = value
        self._at(t_ns)[name] = value

    def finish(self) -> None:
        """Close the sample of the last instant."""
        if self._values:
            values, self._values = self._values, {}
            self.samples.append((self._t_ns, values))
            if self._observer is not None:
                self._observer(self._t_ns, values)

    def _at(self, t_ns: int) -> dict[str, SampleValue]:
        if t_ns != self._t_ns:
            self.finish()
            self._t_ns = t_ns
        return self._values
