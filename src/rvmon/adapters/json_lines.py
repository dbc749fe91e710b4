"""Live data as JSON lines, from a pipe or another stream of bytes."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from rvmon.errors import TraceError
from rvmon.live.clock import SimulatedClock
from rvmon.live.driver import Driver
from rvmon.readers.jsonl_rows import decoded, read_object
from rvmon.readers.line_chunks import LONGEST_LINE
from rvmon.readers.naming import DEFAULT_COLUMNS
from rvmon.trace.sample import Value
from rvmon.trace.schema import Schema
from rvmon.trace.time import TICKS_PER_SECOND

_log = logging.getLogger("rvmon.live.input")

_JUMP_NS = 10 * TICKS_PER_SECOND
"""Stamps that go back by more than this are no late line, but another run."""

_PIECE = 1 << 16
"""Bytes that are asked for at once; what is there is given at once."""


class JsonLines:
    """Reads lines for a driver: an object per sample, as recordings in JSON lines have them.

    Lines without a time are stamped as they arrive. Those with a time are judged at it, and wait
    where others are judged: a pipe that is faster than the monitors is read more slowly, and
    nothing is lost. A line that cannot be read may have said anything: all names are unknown from
    there on.

    Args:
        driver: gets the samples.
        schema: the declared names, and what lines call them.
        clock: follows the stamps of the lines; `None`: the clock of the driver runs by itself.
        robot: the field that names the robot of a line; `None`: there is one robot.

    Attributes:
        ignored: the names that the specification does not declare, with how often they came.
        unread: so many lines could not be read.
    """

    def __init__(
        self,
        driver: Driver,
        schema: Schema,
        *,
        clock: SimulatedClock | None = None,
        robot: str | None = None,
    ) -> None:
        self.ignored: Counter[str] = Counter()
        self.unread = 0
        self._driver = driver
        self._schema = schema
        self._clock = clock
        self._robot = robot
        self._decode = msgspec.json.Decoder().decode
        self._last: dict[str, int | None] = {}

    def feed(self, lines: Iterable[bytes]) -> None:
        """Offer what lines say, until there are no more; to be called in a thread of its own."""
        for number, line in enumerate(lines, 1):
            if line.strip():
                self._take(line, number)

    def _take(self, line: bytes, number: int) -> None:
        robot = ""
        try:
            fields = decoded(line, self._decode)
            if self._robot is not None:
                robot = self._name_of_robot(fields)
            t_ns, values = _read(fields, self._schema, self.ignored)
        except (TraceError, msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            self.unread += 1
            _log.warning("line %d is not taken: %s", number, error)
            values = dict.fromkeys((*self._schema.signals, *self._schema.events))
            for one in [robot] if robot or self._robot is None else self._last:
                last = self._last.get(one)
                t_ns = None if last is None else last + 1  # what came before stays known
                self._driver.offer(values, robot=one, t_ns=t_ns, wait=t_ns is not None)
            return
        self._last[robot] = t_ns
        if self._clock is not None and t_ns is not None:
            now = self._clock.now_ns()
            if t_ns > now or t_ns < now - _JUMP_NS:
                self._clock.set_ns(t_ns)
        self._driver.offer(values, robot=robot, t_ns=t_ns, wait=t_ns is not None)

    def _name_of_robot(self, fields: object) -> str:
        name = fields.pop(self._robot, None) if isinstance(fields, dict) else None
        if not isinstance(name, str | int) or isinstance(name, bool):
            raise TraceError(f"there is no robot's name in `{self._robot}`")
        return str(name)


def stamp_of(line: bytes, schema: Schema) -> int | None:
    """The instant, ns, that a line says; `None` if it says none, or cannot be read."""
    try:
        return _read(decoded(line, msgspec.json.decode), schema, Counter())[0]
    except (TraceError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None


def _read(
    fields: Any, schema: Schema, ignored: Counter[str]
) -> tuple[int | None, dict[str, Value]]:
    """What a decoded line says: its instant, if it has one, and values."""
    stamps = DEFAULT_COLUMNS if schema.stamps is None else (schema.stamps.column,)
    if not isinstance(fields, dict) or any(name in fields for name in stamps):
        return read_object(fields, schema, ignored)
    return None, read_object({**fields, stamps[0]: 0}, schema, ignored)[1]


def read_lines(file: int) -> Iterator[bytes]:
    """The lines of a file, each as soon as it is there.

    Args:
        file: the descriptor of a pipe, a file or a terminal.
    """
    rest = b""
    while piece := os.read(file, _PIECE):
        *whole, rest = (rest + piece).split(b"\n")
        yield from whole
        if len(rest) > LONGEST_LINE:
            yield rest
            rest = b""
    if rest:
        yield rest
