"""Reading of JSON lines line by line: an object per sample, nested names joined with dots."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeVar

import msgspec

from rvmon.errors import TraceError
from rvmon.recordings.values import DESCRIPTION, as_declared, double_of, fits
from rvmon.texts import shorten
from rvmon.trace.sample import Payload, Scalar, Value
from rvmon.trace.schema import Gaps, Kind, Schema
from rvmon.trace.stamps import DEFAULT_COLUMNS, stamps_of, ticks_of_stamp
from rvmon.trace.time import TIME_LIMIT

Line = TypeVar("Line", str, bytes)

MOST_NAMES = 1_000  # the most undeclared names that are counted separately
MORE = "… and more"  # the entry that counts all further names

TOO_DEEP = "it is nested too deeply"

_MISSING = object()

_NOT_FINITE = re.compile(r"\b(NaN|Infinity)\b")

_HALF_PAIR = re.compile(r"\\u[dD][89abAB]..(?!\\u[dD][c-fC-F])")
"""The first half of an escaped surrogate pair without the second."""


_SPACED = re.compile(r'"\s+:')
_SPACED_IN_BYTES = re.compile(rb'"\s+:')  # a quote that may end a name, and blanks before the colon


def jsonl_samples(
    lines: Iterable[str], schema: Schema, ignored: Counter[str], before: int = 0
) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
    """Yield the line number, ticks and values of each line that is not blank.

    Args:
        lines: the lines, of a file that may start with a byte order mark.
        schema: the declared names.
        ignored: counts undeclared names.
        before: the number of lines before `lines`.

    Raises:
        TraceError: with the line's number.
    """
    for name in schema.columns:
        if name not in schema.signals and name.rpartition(".")[0] in schema.events:
            raise TraceError(
                f"`{name}` is a field of an event: in JSON lines only signals and events can "
                "have other names"
            )
    decode = msgspec.json.Decoder().decode
    for number, line in enumerate(lines, 1 + before):
        if number == 1:
            line = line.removeprefix("\ufeff")
        if not line.strip():
            continue
        try:
            t, values = read_object(decoded(line, decode), schema, ignored)
        except msgspec.DecodeError as error:
            cut = "" if line.endswith("\n") else "; the file ends here: was it cut off?"
            raise TraceError(f"line {number}: not a JSON object ({error}){cut}") from None
        except TraceError as error:
            raise TraceError(f"line {number}: {error}") from None
        except RecursionError:
            raise TraceError(f"line {number}: {TOO_DEEP}") from None
        yield number, t, values


def decoded(line: Line, decode: Callable[[Line], Any]) -> Any:
    """The value of a line of JSON.

    NaN and Infinity are accepted, which JSON does not have but many programs write.

    Raises:
        msgspec.DecodeError: the line is no JSON.
        TraceError: a number is too large, a name is in an object twice, or an escaped surrogate
            pair lacks its second half.
    """
    try:
        value = decode(line)
    except msgspec.DecodeError as error:
        text = line if isinstance(line, str) else line.decode("utf-8", "replace")
        if "truncated" in str(error) and _HALF_PAIR.search(text):
            raise TraceError(
                "not a JSON object (half of a surrogate pair such as `\\ud800`)"
            ) from None
        if _NOT_FINITE.search(text):
            try:
                return json.loads(line, parse_float=double_of, object_pairs_hook=_once_each)
            except TraceError:
                raise
            except ValueError:  # report the first error, below
                pass
        raise
    if names_in(line) != count_of_names(value):  # the decoder keeps only the last of equal names
        json.loads(line, object_pairs_hook=_once_each)
    return value


def names_in(text: str | bytes) -> int:
    """The number of names in the objects of a JSON text, found fast.

    In a text that is not plain (blanks before a colon, `":` within a text) the number may be wrong;
    comparing it with `count_of_names` then only makes the caller look closer.

    >>> names_in('{"a": "b:c", "a": {"d":1}}'), names_in('{"a" : 1}')
    (3, -1)
    """
    if isinstance(text, str):
        named, colons = text.count('":'), text.count(":")
        return -1 if colons != named and _SPACED.search(text) else named
    named, colons = text.count(b'":'), text.count(b":")
    return -1 if colons != named and _SPACED_IN_BYTES.search(text) else named


def count_of_names(value: object) -> int:
    """The number of names in the objects of a decoded value.

    >>> count_of_names({"a": 1, "b": [{"c": {}}]})
    3
    """
    if isinstance(value, dict):
        return len(value) + sum(map(count_of_names, value.values()))
    return sum(map(count_of_names, value)) if isinstance(value, list) else 0


def _once_each(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        [(name, count)] = Counter(name for name, _ in pairs).most_common(1)
        raise TraceError(f"`{shorten(name)}` appears {count} times in one object")
    return found


def read_object(
    decoded: object, schema: Schema, ignored: Counter[str]
) -> tuple[int, dict[str, Value]]:
    """Read a decoded line: its ticks, and its values by name; undeclared names are counted.

    Raises:
        TraceError: there is no time, or a value is of the wrong kind; the message names the field.

    >>> schema = Schema({"hand.distance": Kind.REAL}, {"pick": {"id": Kind.INT}, "go": {}})
    >>> line = {"t": 1.5, "hand": {"distance": 1}, "events": ["go"], "pick": {"id": 3}}
    >>> read_object(line, schema, Counter())
    (1500000000, {'go': True, 'hand.distance': 1.0, 'pick': {'id': 3}})
    """
    if not isinstance(decoded, dict):
        raise TraceError('expected an object such as {"t": 0.5, "speed": 0.2}')
    fields = dict(decoded)
    t = _ticks(fields, schema)
    aliases = schema.aliases
    values: dict[str, Value] = {}
    if "events" not in schema.signals and isinstance(fields.get("events"), list | str):
        listed = fields.pop("events")
        if isinstance(listed, str):
            raise TraceError(
                f'`events`: expected a list of names such as ["{shorten(listed)}"], '
                f"found the text `{shorten(listed)}`"
            )
        for name in listed:
            if not isinstance(name, str):
                raise TraceError(f"`events`: `{_written(name)}` is not the name of an event")
            declared = aliases.get(name, name)
            if declared in schema.events:
                values[declared] = True
            else:
                ignored[name] += 1
    _collect(fields, "", schema, aliases, values, ignored)
    bound(ignored)
    return t, values


def _written(value: object) -> str:
    """A decoded value as it is written in JSON, shortened for a message."""
    return shorten(msgspec.json.encode(value).decode())


def _ticks(fields: dict[str, Any], schema: Schema) -> int:
    """The instant of a line (ticks); its stamp is removed from the fields."""
    if schema.stamps is not None:
        stamps = schema.stamps
        stamp = _taken(fields, stamps.column)
        if stamp is _MISSING:
            raise TraceError(f"there is no time `{shorten(stamps.column)}`")
    else:
        given = [name for name in DEFAULT_COLUMNS if name in fields]
        if len(given) != 1:
            raise TraceError("expected one time, `t` (seconds) or `t_ns` (integer nanoseconds)")
        stamps = stamps_of(given[0])
        stamp = fields.pop(given[0])
    if stamps.unit == "ns" and isinstance(stamp, float) and abs(stamp) >= TIME_LIMIT:
        # Beyond 64 bits integers are decoded as floats.
        raise TraceError(f"time `{_written(stamp)}` is out of range: at most 2**62 ns (146 years)")
    if not isinstance(stamp, int | float | str) or isinstance(stamp, bool):
        raise TraceError(f"time `{_written(stamp)}` is neither a number nor a date")
    return ticks_of_stamp(stamp, stamps)


def _taken(fields: dict[str, Any], path: str) -> Any:
    """Remove the value at a path of dotted names from nested fields; `_MISSING`: there is none."""
    if path in fields:
        return fields.pop(path)
    head, dot, rest = path.partition(".")
    inner = fields.get(head)
    if not dot or not isinstance(inner, dict):
        return _MISSING
    return _taken(inner, rest)


def _collect(
    fields: Mapping[str, object],
    prefix: str,
    schema: Schema,
    aliases: Mapping[str, str],
    values: dict[str, Value],
    ignored: Counter[str],
) -> None:
    for key, value in fields.items():
        path = prefix + key
        name = aliases.get(path, path)
        known = name in schema.signals or name in schema.events
        if known and schema.gaps and schema.gaps.holds(value):
            continue
        if name in schema.signals:
            if name in values:
                raise TraceError(f"two fields of the line stand for `{shorten(name)}`")
            values[name] = _scalar(value, schema.signals[name], name)
        elif name in schema.events:
            values[name] = _occurrence(value, schema.events[name], name, schema.gaps)
        elif isinstance(value, dict):
            _collect(value, path + ".", schema, aliases, values, ignored)
        else:
            ignored[path] += 1


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
        return made  # type: ignore[no-any-return]  # it fits
    raise TraceError(f"field `{name}`: `{_written(value)}` is not {DESCRIPTION[kind]}")


def bound(ignored: Counter[str]) -> None:
    """Merge the counts of all names after the first `MOST_NAMES` into `MORE`.

    >>> seen = Counter({f"name{number}": 1 for number in range(MOST_NAMES + 5)})
    >>> bound(seen)
    >>> len(seen) - MOST_NAMES, seen["name0"], seen[MORE]
    (1, 1, 5)
    """
    if len(ignored) > MOST_NAMES + 1:
        further = [name for name in list(ignored)[MOST_NAMES:] if name != MORE]
        ignored[MORE] += sum(ignored.pop(name) for name in further)
