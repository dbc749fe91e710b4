"""Live data as JSON objects, one per sample, also as lines from a pipe or another stream."""

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
"""A stamp farther back than this is not late but starts a new run."""


class JsonObjects:
    """Offers objects as samples, by the same rules as for recordings in JSON lines.

    An unreadable object may have updated any name, so all names are lost between its neighbours.

    Args:
        driver: receives the samples; its specification maps names.
        clock: is set to the stamps of the objects. An object without a stamp is then unreadable,
            because its time is unknown. `None`: the driver has a wall clock, which stamps such an
            object on arrival.
    """

    def __init__(self, driver: Driver, *, clock: SimulatedClock | None = None) -> None:
        # undeclared names, with their numbers of occurrences
        self.ignored: Counter[str] = Counter()
        self.unread = 0  # the number of objects that could not be read
        self.driver = driver  # receives the samples
        self._clock = clock
        self._last: dict[str, int | None] = {}
        self._logged = 0
        # whether an object was lost that may belong to a robot not known yet
        self._is_any_lost = False

    def take(
        self, fields: Any, robot: str = "", *, wait: bool = False, is_old: bool = False
    ) -> None:
        """Offer an object as a sample.

        Args:
            fields: the decoded object.
            robot: the name of the robot.
            wait: whether to wait for room; see `Driver.offer`.
            is_old: whether it is a retained message, whose events did not occur now.

        Raises:
            TraceError: the object cannot be read; nothing was offered.
        """
        spec = self.driver.spec
        t_ns, values = _read(fields, spec.schema, self.ignored)
        if self._clock is not None and t_ns is None:
            if not values:
                return  # it contains no declared name
            column = DEFAULT_COLUMNS[0] if spec.schema.stamps is None else spec.schema.stamps.column
            raise TraceError(f"there is no time `{column}`, so the time of the sample is unknown")
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
        # An object without a stamp gets one when it is offered, so waiting would change its time.
        waits = wait and t_ns is not None
        is_queued = self.driver.offer(values, robot=robot, t_ns=t_ns, wait=waits)
        if self.driver.spec is not spec:  # replaced meanwhile, perhaps with other names
            self.driver.miss(robot=robot, why=_UNREADABLE)
        # Robots beyond the limit are not remembered, so that the table stays bounded.
        if is_queued or robot in self._last or len(self._last) < self.driver.most_robots:
            self._last[robot] = t_ns

    def _log_ignored(self) -> None:
        """Log, for each new undeclared name, the declared name that was probably meant."""
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
        _log.warning("%s is rejected: %s", where, why)
        for one in self._last if robot is None else [robot]:
            if self._last.get(one) is None:  # its objects have no stamps: the loss was just now
                self.driver.lose(robot=one, is_over=True, why=_UNREADABLE)
            else:
                self.driver.miss(robot=one, why=_UNREADABLE)


def decoded_object(text: bytes) -> Any:
    """Decode JSON text.

    Raises:
        TraceError: the text is not JSON.
    """
    try:
        return decoded(text, msgspec.json.decode)
    except RecursionError:
        raise TraceError(TOO_DEEP) from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        is_other = text.lstrip()[:1] != b"{"
        wanted = '; expected `{"t": 0, "speed": 0.5}`; `rvmon run` reads CSV' if is_other else ""
        raise TraceError(f"{error}{wanted}") from None


PROLOGUE = 10  # the most lines examined to find out whether a stream has stamps


def first_lines(lines: Iterable[bytes], schema: Schema) -> tuple[list[bytes], int | None]:
    """Read the first lines of a stream, up to the one that shows whether its lines have stamps.

    Programs often print a greeting first. So lines that are unreadable, or have neither a stamp nor
    a declared name, are passed over.

    Returns:
        The lines read, and the stamp of the last one, ns; `None` if it has none, or if `PROLOGUE`
        lines showed nothing.
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
    """The stamp of an object in ns, `None` if it has none, and its values."""
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
    """Offer lines as samples until they end or the driver is closed; to run in its own thread.

    Lines with stamps wait for room in the queue. So a pipe that is faster than the monitors is
    slowed down, and nothing is lost.

    `robot` is the field with the name of the robot; `None`: there is only one.
    """
    with suppress(RvmonError):  # the driver was closed
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            # If the robot's name cannot be read, the line may belong to any robot.
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
        raise TraceError(f"there is no robot name in `{robot}`")
    return str(name)


def read_lines(file: int) -> Iterator[bytes]:
    """The lines of a pipe, file or terminal, each once it is complete, without a byte order mark.

    A longer line than `LONGEST_LINE` comes in pieces.
    """
    pieces: list[bytes] = []  # pieces of an incomplete line, joined once to avoid quadratic cost
    length, mark = 0, BOM_UTF8
    while piece := os.read(file, _PIECE):
        *whole, rest = piece.split(b"\n")
        if whole:
            whole[0] = b"".join([*pieces, whole[0]]).removeprefix(mark)
            pieces, length, mark = [], 0, b""
            yield from whole
        pieces.append(rest)
        length += len(rest)
        if length > LONGEST_LINE:
            yield b"".join(pieces)
            pieces, length = [], 0
    if rest := b"".join(pieces).removeprefix(mark):
        yield rest
