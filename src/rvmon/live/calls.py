"""Calls of functions as events of a robot."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar

from rvmon.live.driver import Driver

_P = ParamSpec("_P")
_R = TypeVar("_R")


def as_event(
    driver: Driver,
    event: str,
    *,
    ended: str | None = None,
    payload: Callable[_P, Mapping[str, Any]] | None = None,
    robot: str = "",
) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """A decorator: each call of the function is an occurrence of an event.

    Args:
        driver: gets the events.
        event: occurs when the function is called.
        ended: occurs when it has returned, or a coroutine has ended; not where it raises.
        payload: gives the fields of both for the arguments of a call.
        robot: whose events they are.

    >>> from rvmon import loads
    >>> from rvmon.live import Driver, SimulatedClock, as_event
    >>> spec = loads('''
    ... spec s
    ... event grip, gripped
    ... requirement R
    ...   upon grip
    ...   then within 2 s gripped
    ... ''')
    >>> driver = Driver(spec, clock=SimulatedClock())
    >>> @as_event(driver, "grip", ended="gripped")
    ... def grip(width):
    ...     return width / 2
    >>> grip(3)
    1.5
    >>> driver.close()[""][0].verdicts["R"]
    <Verdict.PASS: 'P'>
    """

    def decorate(function: Callable[_P, _R]) -> Callable[_P, _R]:
        def occurs(name: str | None, *args: _P.args, **kwargs: _P.kwargs) -> None:
            if name is not None:
                value = True if payload is None else dict(payload(*args, **kwargs))
                driver.offer({name: value}, robot=robot)

        if inspect.iscoroutinefunction(function):

            @functools.wraps(function)
            async def awaited(*args: _P.args, **kwargs: _P.kwargs) -> Any:
                occurs(event, *args, **kwargs)
                result = await function(*args, **kwargs)
                occurs(ended, *args, **kwargs)
                return result

            return awaited  # type: ignore[return-value]

        @functools.wraps(function)
        def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            occurs(event, *args, **kwargs)
            result = function(*args, **kwargs)
            occurs(ended, *args, **kwargs)
            return result

        return called

    return decorate
