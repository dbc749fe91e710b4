"""Who is called with what a monitor decides."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.errors import RvmonError
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict

Callback = Callable[[Attempt], object]


class Listeners:
    """The callbacks of a monitor, in the order in which they were registered."""

    def __init__(self) -> None:
        self._callbacks: dict[object, tuple[bool, Callback]] = {}

    def __bool__(self) -> bool:
        return bool(self._callbacks)

    def add(
        self, callback: Callback, changed: Callable[[], None], *, failures_only: bool
    ) -> Callable[[], None]:
        """Register a callback.

        Returns:
            A function without arguments that ends this; to call it again does nothing.

        Raises:
            RvmonError: it cannot be called.
        """
        if not callable(callback):
            raise RvmonError(f"expected a function that takes an attempt, found {callback!r}")
        key = object()
        self._callbacks[key] = (failures_only, callback)
        changed()

        def stop() -> None:
            self._callbacks.pop(key, None)
            changed()

        return stop

    def call(self, decided: Sequence[Attempt]) -> None:
        """Call the callbacks, which may call the monitor: the call that decided is over.

        Raises:
            Exception: what a callback raised, when all were called; several as a group.
        """
        if not self._callbacks:
            return
        errors: list[Exception] = []
        for attempt in decided:
            for failures_only, callback in tuple(self._callbacks.values()):
                asked = attempt.verdict is Verdict.FAIL or not failures_only
                if attempt.decided is None or not asked:
                    continue
                try:
                    callback(attempt)
                except Exception as error:  # noqa: BLE001 - the others are called first
                    errors.append(error)
        if len(errors) > 1:
            raise ExceptionGroup("several callbacks of a monitor failed", errors)
        if errors:
            raise errors[0]
