"""JSON lines: an object per sample, nested names joined with dots."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any

import msgspec

from rvmon.errors import TraceError
from rvmon.readers.gaps import NO_GAPS, Gaps
from rvmon.readers.values import DESCRIPTION, as_declared, fits, shorten
from rvmon.trace.sample import Payload, Scalar, Value
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.time import TIME_LIMIT, ticks_of_seconds

_MISSING = object()

_NAN = re.compile(r"\bNaN\b")

_HALF_PAIR = re.compile(r"\\u[dD][89abAB]..(?!\\u[dD][c-fC-F])")
"""The first half of an escaped surrogate pair without the second."""


def jsonl_samples(
    lines: Iterable[str], schema: Schema, ignored: Counter[str], gaps: Gaps = NO_GAPS
) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
    """Line number, ticks and values of each line that is not blank.

    Args:
        lines: text, one JSON object a line.
        schema: the declared names.
        ignored: names that the spec does not declare are counted here.
        gaps: values that stand for no update.

    Raises:
        TraceError: with the line's number.
    """
    decode = msgspec.json.Decoder().decode
    for number, line in enumerate(lines, 1):
        if number == 1:
            line = line.removeprefix("\ufeff")
        if not line.strip():
            continue
        try:
            t, values = read_object(_decoded(line, decode), schema, ignored, gaps)
        except msgspec.DecodeError as error:
            if "truncated" in str(error) and _HALF_PAIR.search(line):
                raise TraceError(
                    f"line {number}: not a JSON object (half of a surrogate pair such as `\\ud800`)"
                ) from None
            cut = "" if line.endswith("\n") else "; the file ends here: was it cut off?"
            raise TraceError(f"line {number}: not a JSON object ({error}){cut}") from None
        except UnicodeEncodeError:  # standard input may stand in for what it cannot decode
            raise TraceError(f"line {number}: not UTF-8 text: is this a binary file?") from None
        except (TraceError, RecursionError) as error:
            raise TraceError(f"line {number}: {error}") from None
        yield number, t, values


def _decoded(line: str, decode: Callable[[str], Any]) -> Any:
    """The value of a line; JSON has no NaN, but many that write JSON do."""
    try:
        return decode(line)
    except msgspec.DecodeError:
        if _NAN.search(line):
            with suppress(ValueError):
                return json.loads(line)
        raise


def read_object(
    decoded: object, schema: Schema, ignored: Counter[str], gaps: Gaps = NO_GAPS
) -> tuple[int, dict[str, Value]]:
    """Read one decoded line: ticks and what it updates.

    Raises:
        TraceError: no time, or a value of the wrong kind; the message names the field.

    >>> schema = Schema({"hand.distance": Kind.REAL}, {"pick": {"id": Kind.INT}, "go": {}})
    >>> line = {"t": 1.5, "hand": {"distance": 1}, "events": ["go"], "pick": {"id": 3}}
    >>> read_object(line, schema, Counter())
    (1500000000, {'go': True, 'hand.distance': 1.0, 'pick': {'id': 3}})
    """
    if not isinstance(decoded, dict):
        raise TraceError('expected an object such as {"t": 0.5, "speed": 0.2}')
    fields = dict(decoded)
    t = _ticks(fields)
    values: dict[str, Value] = {}
    if "events" not in schema.signals and isinstance(fields.get("events"), list | str):
        for name in _listed(fields.pop("events")):
            if not isinstance(name, str):
                raise TraceError(f"`events`: `{_written(name)}` is not the name of an event")
            if name in schema.events:
                values[name] = True
            else:
                ignored[name] += 1
    _collect(fields, "", schema, values, ignored, gaps)
    return t, values


def _listed(events: list[object] | str) -> list[object]:
    if isinstance(events, str):
        raise TraceError(
            f'`events`: expected a list of names such as ["{shorten(events)}"], '
            f"found the text `{shorten(events)}`"
        )
    return events


def _written(value: object) -> str:
    """A decoded value as it stands in the line, shortened."""
    return shorten(value if isinstance(value, str) else msgspec.json.encode(value).decode())


def _ticks(fields: dict[str, Any]) -> int:
    seconds, ticks = fields.pop("t", _MISSING), fields.pop("t_ns", _MISSING)
    if (seconds is _MISSING) == (ticks is _MISSING):
        raise TraceError("expected one time, `t` (seconds) or `t_ns` (integer nanoseconds)")
    if seconds is not _MISSING:
        if not isinstance(seconds, (int, float)) or isinstance(seconds, bool):
            raise TraceError(f"time `{_written(seconds)}` is not a number of seconds")
        return ticks_of_seconds(seconds)
    if isinstance(ticks, (int, float)) and not isinstance(ticks, bool):
        if abs(ticks) >= TIME_LIMIT:  # beyond 64 bits integers are decoded as floats
            raise TraceError(
                f"time `{_written(ticks)}` is out of range: at most 2**62 ns (146 years)"
            )
        if isinstance(ticks, int):
            return ticks
    raise TraceError(f"time `{_written(ticks)}` is not a whole number of nanoseconds")


def _collect(
    fields: Mapping[str, object],
    prefix: str,
    schema: Schema,
    values: dict[str, Value],
    ignored: Counter[str],
    gaps: Gaps,
) -> None:
    for key, value in fields.items():
        name = prefix + key
        if gaps and gaps.holds(value) and (name in schema.signals or name in schema.events):
            continue
        if name in schema.signals:
            values[name] = _scalar(value, schema.signals[name], name)
        elif name in schema.events:
            values[name] = _occurrence(value, schema.events[name], name, gaps)
        elif isinstance(value, dict):
            _collect(value, name + ".", schema, values, ignored, gaps)
        else:
            ignored[name] += 1


def _occurrence(value: object, fields: Mapping[str, Kind], name: str, gaps: Gaps) -> Value:
    made = as_declared(value, Kind.BOOL)
    if made is None or isinstance(made, bool):
        return made
    if isinstance(value, dict):
        return _payload(value, fields, name, gaps)
    if isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        return tuple(_payload(item, fields, name, gaps) for item in value)
    raise TraceError(
        f"event `{name}`: expected true, false or a payload such as {{...}}, "
        f"found `{_written(value)}`"
    )


def _payload(
    value: Mapping[str, object], fields: Mapping[str, Kind], name: str, gaps: Gaps
) -> Payload:
    return {
        key: _scalar(item, fields[key], f"{name}.{key}")
        for key, item in value.items()
        if key in fields and not gaps.holds(item)
    }


def _scalar(value: object, kind: Kind, name: str) -> Scalar:
    made = as_declared(value, kind)
    if fits(made, kind):
        return made  # type: ignore[no-any-return]
    raise TraceError(f"field `{name}`: `{_written(value)}` is not {DESCRIPTION[kind]}")
