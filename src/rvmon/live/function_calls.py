"""Function calls as events of a robot.

Monitoring never makes a call fail: an event that the driver refuses is logged.
"""

from __future__ import annotations

import functools
import inspect
import logging
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar

from rvmon.errors import RvmonError
from rvmon.live.driver import Driver

_log = logging.getLogger("rvmon.live.input")

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

    For a coroutine or generator, the event occurs when it starts to run.

    Args:
        driver: receives the events.
        event: occurs when the function is called.
        ended: occurs when the function returns or the coroutine or generator ends; not if it raises
            or is abandoned.
        payload: computes the fields of both events from the arguments of a call; if it raises, the
            event is unknown at that instant.
        robot: the name of the robot.

    Raises:
        RvmonError: the decorated object is a class, an asynchronous generator, or not callable.

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
            if name is None:
                return
            value: object = True
            if payload is not None:
                try:
                    value = dict(payload(*args, **kwargs))
                except Exception as error:  # noqa: BLE001 - `payload` must not fail the call
                    _log.warning("the payload of %s is unknown: %r", name, error)
                    value = None
            try:
                driver.offer({name: value}, robot=robot)
            except RvmonError as error:
                _log.warning("%s is lost: %s", name, error)

        if inspect.isclass(function) or not callable(function):
            raise RvmonError(f"{function!r}: decorate a function, such as the method `__init__`")
        if inspect.isasyncgenfunction(function):
            raise RvmonError(f"{function!r}: decorate what this asynchronous generator awaits")
        if inspect.isgeneratorfunction(function):

            @functools.wraps(function)
            def iterated(*args: _P.args, **kwargs: _P.kwargs) -> Any:
                occurs(event, *args, **kwargs)
                result = yield from function(*args, **kwargs)
                occurs(ended, *args, **kwargs)
                return result

            return iterated

        if inspect.iscoroutinefunction(function):

            @functools.wraps(function)
            async def awaited(*args: _P.args, **kwargs: _P.kwargs) -> Any:
                occurs(event, *args, **kwargs)
                result = await function(*args, **kwargs)
                occurs(ended, *args, **kwargs)
                return result

            return awaited  # type: ignore[return-value]  # of the same arguments

        @functools.wraps(function)
        def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            occurs(event, *args, **kwargs)
            result = function(*args, **kwargs)
            occurs(ended, *args, **kwargs)
            return result

        return called

    return decorate
