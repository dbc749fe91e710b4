"""Verdicts on a recording as an MCAP file, with a layout for Foxglove.

Source: the MCAP specification, https://mcap.dev/spec; the schema `foxglove.Log`,
https://docs.foxglove.dev/docs/visualization/message-schemas/log.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from heapq import merge
from importlib.util import find_spec
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import Any

import msgspec

from rvmon.errors import RvmonError, not_installed, writing
from rvmon.files import staged, write_whole
from rvmon.language.checked.specification import CheckedSpec
from rvmon.report.foxglove_layout import (
    ATTEMPTS,
    SCENE,
    foxglove_layout,
    scene_updates,
    seconds_and_rest,
    topic_of,
)
from rvmon.report.tracks import Scene, names_of_requirement
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdicts import LAW, Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

_LEVELS = {Verdict.PASS: 2, Verdict.INCONCLUSIVE: 3, Verdict.FAIL: 4}
"""The levels of `foxglove.Log`: information, warning, error."""

_TYPES = {Kind.BOOL: "boolean", Kind.INT: "integer", Kind.REAL: "number", Kind.LABEL: "string"}

_STATE = {"state": "string"} | dict.fromkeys(("open", "passed", "failed", "undecided"), "integer")
_OF_ATTEMPT = "level message name file line verdict reason triggered decided"
_WHOLE = ("level", "line", "triggered", "decided")
_ATTEMPT = {name: "integer" if name in _WHOLE else "string" for name in _OF_ATTEMPT.split()}

_Message = tuple[int, str, Mapping[str, Any]]  # ticks, topic, content


def refuse_mcap(path: str) -> None:
    """Refuse, before anything is judged, a path or installation that cannot write MCAP.

    Raises:
        RvmonError: the suffix is another one, or mcap is not installed.
    """
    if not path.endswith(".mcap"):
        raise RvmonError(f"cannot write {path}: the name of an MCAP file ends in .mcap")
    if find_spec("mcap") is None:
        raise not_installed("MCAP", "mcap")


def layout_path(path: str) -> str:
    """The path of the layout file, next to that of the verdicts."""
    return f"{path}.layout.json"


def write_verdicts(
    path: str,
    spec: CheckedSpec,
    report: Report,
    samples: Iterable[Sample],
    scene: Scene | None = None,
) -> None:
    """Write states of requirements, attempts and values over time, and the layout file.

    `samples` are those up to the end of the report; if there are none, values are left out.

    Raises:
        RvmonError: a file cannot be written, or an instant is before 1970.
    """
    recorded = iter(samples)
    first = next(recorded, None)
    earliest = report.end or 0
    if first is not None:
        earliest, recorded = first.t, chain((first,), recorded)
    else:
        earliest = min((attempt.triggered for attempt in report.attempts), default=earliest)
    if earliest < 0:
        raise RvmonError(f"cannot write {path}: MCAP has no instants before 0 s")
    names = {
        name
        for verdict in report.verdicts
        for name in names_of_requirement(spec.requirements[verdict])
    }
    states = sorted(_states(report, earliest), key=itemgetter(0))
    frames = [] if scene is None else [(t, SCENE, one) for t, one in scene_updates(scene)]
    values = _values(spec, recorded, names)
    messages = merge(states, _attempts(spec, report), values, frames, key=itemgetter(0))
    # For each topic, the name of its schema and the types of its fields.
    schemas: dict[str, tuple[str, Mapping[str, str]]] = {ATTEMPTS: ("foxglove.Log", _ATTEMPT)}
    for name in report.verdicts:
        schemas[topic_of("requirements", name)] = "rvmon.Requirement", _STATE
    if first is not None:
        schemas |= _value_schemas(spec, names)
    if scene is not None:
        schemas[SCENE] = "foxglove.SceneUpdate", {"deletions": "array", "entities": "array"}
    layout = foxglove_layout(spec, report.verdicts, names if first is not None else (), scene)
    with writing(path):
        with staged(path) as place:
            _write(place, schemas, messages)
        write_whole(layout_path(path), msgspec.json.format(msgspec.json.encode(layout)))


def _value_schemas(
    spec: CheckedSpec, names: Iterable[str]
) -> dict[str, tuple[str, Mapping[str, str]]]:
    schemas: dict[str, tuple[str, Mapping[str, str]]] = {}
    for name in sorted(names):
        if name in spec.signals:
            kind = _TYPES[spec.signals[name].type.kind]
            members = {"known": "boolean", "value": kind}
            schemas[topic_of("signals", name)] = f"rvmon.{kind}", members
        else:
            fields = {field: _TYPES[one.kind] for field, one in spec.events[name].fields.items()}
            members = {"occurs": "boolean", **fields}
            schemas[topic_of("events", name)] = f"rvmon.event.{name}", members
    return schemas


def _states(report: Report, earliest: int) -> Iterator[_Message]:
    """The state of each requirement at the start and at each change."""
    changes: dict[str, dict[int, list[tuple[int, Verdict | None]]]] = {}
    end = report.end or 0
    for attempt in report.attempts:
        of_requirement = changes.setdefault(attempt.requirement, {})
        of_requirement.setdefault(attempt.triggered, []).append((1, None))
        of_requirement.setdefault(_settled(attempt, end), []).append((-1, attempt.verdict))
    for name in report.verdicts:
        still_open, last, counts = 0, Verdict.NOT_TRIGGERED, Counter[Verdict]()
        for t, steps in sorted({earliest: [], **changes.get(name, {})}.items()):
            for step, verdict in steps:
                still_open += step
                if verdict is not None:
                    counts[verdict] += 1
                    last = verdict
            content = {
                "state": "open" if still_open else last.value,
                "open": still_open,
                "passed": counts[Verdict.PASS],
                "failed": counts[Verdict.FAIL],
                "undecided": counts[Verdict.INCONCLUSIVE],
            }
            yield t, topic_of("requirements", name), content


def _settled(attempt: Attempt, end: int) -> int:
    """The decision instant of an attempt, else the end of the recording; not before its trigger."""
    return max(attempt.triggered, end if attempt.decided is None else attempt.decided)


def _attempts(spec: CheckedSpec, report: Report) -> list[_Message]:
    """A log entry for each attempt at its decision."""
    messages: list[_Message] = []
    for attempt in report.attempts:
        span = spec.requirements[attempt.requirement].span
        t = _settled(attempt, report.end or 0)
        content = {
            "timestamp": seconds_and_rest(t),
            "level": _LEVELS[attempt.verdict],
            "message": f"{attempt.verdict} {attempt.reason}".rstrip(),
            "name": attempt.name,
            "file": "" if span is None else span.source.name,
            "line": 0 if span is None else span.line,
            "verdict": attempt.verdict.value,
            "reason": attempt.reason,
            "triggered": attempt.triggered,
        }
        if attempt.decided is not None:
            content["decided"] = attempt.decided
        messages.append((t, ATTEMPTS, content))
    return sorted(messages, key=itemgetter(0))


def _values(
    spec: CheckedSpec, samples: Iterable[Sample], names: Collection[str]
) -> Iterator[_Message]:
    """The values of the names that requirements read."""
    for sample in samples:
        for name, value in sample.values.items():
            if name not in names:
                continue
            if name in spec.signals:
                yield sample.t, topic_of("signals", name), _value_message(value)
            elif value:
                for payload in value if isinstance(value, tuple) else (value,):
                    fields = payload if isinstance(payload, Mapping) else {}
                    yield sample.t, topic_of("events", name), {"occurs": True, **fields}


def _value_message(value: object) -> dict[str, object]:
    """The message for a value of a signal; JSON has no NaN and no infinity."""
    if value is None or value != value:
        return {"known": False}
    # An infinity is known, but nothing can be plotted for it.
    finite = not isinstance(value, float) or math.isfinite(value)
    return {"known": True, "value": value} if finite else {"known": True}


def _write(
    path: Path, schemas: Mapping[str, tuple[str, Mapping[str, str]]], messages: Iterable[_Message]
) -> None:
    from mcap.writer import Writer

    with open(path, "wb") as file:
        writer: Any = Writer(file)
        writer.start(library=f"rvmon, law {LAW}")
        channels = {}
        for topic, (name, fields) in schemas.items():
            schema = writer.register_schema(name, "jsonschema", _json_schema(fields, name))
            channels[topic] = writer.register_channel(topic, "json", schema)
        for t, topic, content in messages:
            channel = channels[topic]
            writer.add_message(channel, t, msgspec.json.encode(content), t)
        writer.finish()


def _json_schema(fields: Mapping[str, str], title: str) -> bytes:
    properties: dict[str, Any] = {name: {"type": kind} for name, kind in fields.items()}
    for described in properties.values():
        if described["type"] == "array":
            described["items"] = {"type": "object", "properties": {}}
    if title == "foxglove.Log":
        parts = {part: {"type": "integer"} for part in ("sec", "nsec")}
        properties["timestamp"] = {"type": "object", "title": "time", "properties": parts}
    return msgspec.json.encode({"title": title, "type": "object", "properties": properties})
