"""Live data as JSON objects, one per sample; also as lines from a pipe or another stream."""

from __future__ import annotations

import logging
import os
from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice
from typing import Any

import msgspec

from rvmon.errors import RvmonError, TraceError
from rvmon.live.clock import SimulatedClock
from rvmon.live.driver import Driver
from rvmon.recordings.jsonl_rows import TOO_DEEP, decoded, read_object
from rvmon.recordings.places import LONGEST_LINE
from rvmon.trace.sample import Value
from rvmon.trace.schema import Schema
from rvmon.trace.stamps import DEFAULT_COLUMNS
from rvmon.trace.time import TICKS_PER_SECOND

_log = logging.getLogger("rvmon.live.input")

_UNREADABLE = "it cannot be read"

_JUMP_NS = 10 * TICKS_PER_SECOND
"""A stamp farther back than this is not late, but begins another run."""


class JsonObjects:
    """Offers objects as samples, by the same rules as for recordings in JSON lines.

    One that cannot be read may have updated any name: all names are lost between its neighbours.

    Args:
        driver: receives the samples; its specification maps names.
        clock: set to the stamps of the objects, so that one without a stamp cannot be read: nobody
            knows when between its neighbours it came. `None`: the driver has a wall clock, by which
            such an object is stamped on arrival.
    """

    def __init__(self, driver: Driver, *, clock: SimulatedClock | None = None) -> None:
        # names that are not declared, with their numbers of occurrences
        self.ignored: Counter[str] = Counter()
        self.unread = 0  # the number of objects that could not be read
        self.driver = driver  # receives the samples
        self._clock = clock
        self._last: dict[str, int | None] = {}
        self._logged = 0
        self._is_any_lost = False  # a lost object may have been of a robot not known yet

    def take(
        self, fields: Any, robot: str = "", *, wait: bool = False, is_old: bool = False
    ) -> None:
        """Offer an object as a sample.

        Args:
            fields: the decoded object.
            robot: the name of the robot.
            wait: whether to wait for room; see `Driver.offer`.
            is_old: whether it is a retained message, whose events are not of now.

        Raises:
            TraceError: it cannot be read; nothing was offered.
        """
        spec = self.driver.spec
        t_ns, values = _read(fields, spec.schema, self.ignored)
        if self._clock is not None and t_ns is None:
            if not values:
                return  # it says nothing of what is judged
            column = DEFAULT_COLUMNS[0] if spec.schema.stamps is None else spec.schema.stamps.column
            raise TraceError(f"there is no time `{column}`: who knows when it was?")
        if is_old:
            values = {name: value for name, value in values.items() if name in spec.schema.signals}
        if len(self.ignored) > self._logged:
            self._log_ignored()
        if self._clock is not None and t_ns is not None:
            now = self._clock.now_ns()
            if t_ns > now or t_ns < now - _JUMP_NS:
                self._clock.set_ns(t_ns)
        if self._is_any_lost and robot not in self._last:
            self.driver.miss(robot=robot, why=_UNREADABLE)
        # An object without a stamp gets one when it is offered: waiting would change its time.
        waits = wait and t_ns is not None
        is_queued = self.driver.offer(values, robot=robot, t_ns=t_ns, wait=waits)
        if self.driver.spec is not spec:  # replaced meanwhile, perhaps by one with other names
            self.driver.miss(robot=robot, why=_UNREADABLE)
        # Robots beyond the limit are not remembered, lest the table grow without bound.
        if is_queued or robot in self._last or len(self._last) < self.driver.most_robots:
            self._last[robot] = t_ns

    def _log_ignored(self) -> None:
        """Log, for a new undeclared name, the declared one that was probably meant."""
        fresh = list(islice(self.ignored, self._logged, None))
        self._logged += len(fresh)
        signals = self.driver.spec.schema.signals
        for name in fresh:
            ends = [signal for signal in signals if name.endswith(f".{signal}")]
            ends += [signal for signal in signals if signal.endswith(f".{name}")]
            if ends:
                _log.warning(
                    "`%s` feeds nothing, and `%s` is declared: is `--map %s=%s` meant?",
                    *(name, ends[0], ends[0], name),
                )

    def lose(self, where: str, why: Exception, robot: str | None) -> None:
        """Report an outage of all names for an unreadable object.

        Args:
            where: the object's origin, for the log.
            why: the reason why it cannot be read.
            robot: its robot; `None`: unknown.
        """
        self.unread += 1
        self._is_any_lost = self._is_any_lost or robot is None
        _log.warning("%s is not taken: %s", where, why)
        for one in self._last if robot is None else [robot]:
            if self._last.get(one) is None:  # its objects have no time and are stamped on arrival
                self.driver.lose(robot=one, is_over=True, why=_UNREADABLE)
            else:
                self.driver.miss(robot=one, why=_UNREADABLE)


def decoded_object(text: bytes) -> Any:
    """Decode a text.

    Raises:
        TraceError: it is no JSON.
    """
    try:
        return decoded(text, msgspec.json.decode)
    except RecursionError:
        raise TraceError(TOO_DEEP) from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        is_other = text.lstrip()[:1] != b"{"
        wanted = '; wanted is `{"t": 0, "speed": 0.5}`; `rvmon run` reads CSV' if is_other else ""
        raise TraceError(f"{error}{wanted}") from None


PROLOGUE = 10  # the most lines that are looked at for the first one that says what the stream is of


def begin_of(lines: Iterable[bytes], schema: Schema) -> tuple[list[bytes], int | None]:
    """The first lines of a stream, up to the one that says whether its lines have stamps; not more.

    Programs greet before they report: a line that cannot be read, or that has neither a stamp nor a
    declared name, does not say it.

    Returns:
        The lines, and the stamp of the last one, ns; `None`: it has none, or `PROLOGUE` lines said
        nothing.
    """
    taken: list[bytes] = []
    for line in lines:
        taken.append(line)
        if not line.strip():
            continue
        with suppress(TraceError):
            t_ns, values = _read(decoded_object(line), schema, Counter())
            if t_ns is not None or values:
                return taken, t_ns
        if len(taken) >= PROLOGUE:
            break
    return taken, None


def _read(
    fields: Any, schema: Schema, ignored: Counter[str]
) -> tuple[int | None, dict[str, Value]]:
    """The stamp of an object, if it has one, and its values."""
    stamps = DEFAULT_COLUMNS if schema.stamps is None else (schema.stamps.column,)
    try:
        if not isinstance(fields, dict) or any(name in fields for name in stamps):
            return read_object(fields, schema, ignored)
        # The reader of recordings requires a stamp; this one is not used.
        return None, read_object({**fields, stamps[0]: 0}, schema, ignored)[1]
    except RecursionError:
        raise TraceError(TOO_DEEP) from None


_PIECE = 1 << 16  # the most bytes read at once


def feed_lines(objects: JsonObjects, lines: Iterable[bytes], robot: str | None = None) -> None:
    """Offer lines as samples, until they end or the driver is closed; call it in its own thread.

    Lines with a time wait for room in the queue, so that a pipe faster than the monitors is slowed
    down and nothing is lost.

    `robot` is the field with the name of the robot; `None`: there is only one.
    """
    with suppress(RvmonError):  # the driver was closed
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            # If the robot's name cannot be read, the line may be of any robot.
            name = "" if robot is None else None
            try:
                fields = decoded_object(line)
                if robot is not None:
                    name = _name_of_robot(fields, robot)
                objects.take(fields, name or "", wait=True)
            except TraceError as error:
                objects.lose(f"line {number}", error, name)


def _name_of_robot(fields: object, robot: str) -> str:
    name = fields.pop(robot, None) if isinstance(fields, dict) else None
    if not isinstance(name, str | int) or isinstance(name, bool):
        raise TraceError(f"there is no robot's name in `{robot}`")
    return str(name)


def read_lines(file: int) -> Iterator[bytes]:
    """The lines of a pipe, file or terminal, each once it is whole, without a byte order mark."""
    begun: list[bytes] = []  # the pieces of a line without its end, joined once
    length, mark = 0, BOM_UTF8
    while piece := os.read(file, _PIECE):
        *whole, rest = piece.split(b"\n")
        if whole:
            whole[0] = b"".join([*begun, whole[0]]).removeprefix(mark)
            begun, length, mark = [], 0, b""
            yield from whole
        begun.append(rest)
        length += len(rest)
        if length > LONGEST_LINE:
            yield b"".join(begun)
            begun, length = [], 0
    if rest := b"".join(begun).removeprefix(mark):
        yield rest
