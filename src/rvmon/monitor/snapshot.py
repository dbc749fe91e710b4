"""A run as bytes: taken anywhere, put into a monitor of the same specification.

The format is one line (kind, checksum) and JSON. It is checked before anything is taken from it,
and nothing in it is executed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from rvmon.automaton.progression import Progression
from rvmon.errors import SnapshotError, TraceError
from rvmon.monitor.build import build_monitor
from rvmon.monitor.freeze import Freezer, Thawer
from rvmon.monitor.judge import Judge
from rvmon.monitor.monitor import Monitor
from rvmon.trace.time import whole_ticks
from rvmon.verdict.verdict import LAW

if TYPE_CHECKING:
    from rvmon.dataflow.nodes import Plan
    from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec
    from rvmon.spec.checked.specification import CheckedSpec

_KIND = b"rvmon snapshot 1"

_UNSAID = ("span", "source", "text", "title", "doc")
"""Fields of a specification that do not change what is judged."""


def snapshot(monitor: Monitor) -> bytes:
    """The run of a monitor; see `Monitor.snapshot`."""
    choice, lanes = monitor.choice, monitor.lanes
    document = {
        "rvmon": _version(),
        "spec": _digest_of(choice.compiled),
        "only": [one.requirement.id for one in choice.requirements],
        "engine": choice.engine,
        "settle": choice.settle,
        "sources": None if choice.sources is None else sorted(choice.sources),
        "keep": choice.keep,
        "machines": [_machine(one, choice.engine) for one in choice.requirements],
        "locations": {name: machine.table() for name, _, machine in _progressing(monitor)},
    }
    freezer = Freezer(_plans(choice.compiled))
    document["lanes"] = freezer.freeze(lanes.shape())
    document["state"] = freezer.freeze(monitor)
    body = json.dumps(document, separators=(",", ":")).encode()
    return b"%s %s\n%s" % (_KIND, hashlib.sha256(body).hexdigest().encode(), body)


def restore(compiled: CompiledSpec, data: bytes) -> Monitor:
    """The monitor that a snapshot was taken of.

    Args:
        compiled: the specification.
        data: from `snapshot`.

    Raises:
        SnapshotError: the bytes are no snapshot, or one of another specification or version.
    """
    document = _document(data)
    if document.get("rvmon") != _version():
        raise SnapshotError(
            f"the snapshot was made by rvmon {document.get('rvmon')}, this is {_version()}: "
            "restore it with the version that made it"
        )
    if document.get("spec") != _digest_of(compiled):
        raise SnapshotError(
            f"the snapshot was made with another specification than `{compiled.checked.name}`: "
            "load the one it was made with, with the same constants"
        )
    try:
        _rehearse(_restored(compiled, document))
        monitor = _restored(compiled, document)
    except SnapshotError:
        raise
    except Exception:  # noqa: BLE001 - whatever a hostile snapshot leads to
        raise SnapshotError("the snapshot is damaged: what it holds fits no monitor") from None
    monitor.one_call.restored = True
    return monitor


def _rehearse(monitor: Monitor) -> None:
    """Lead a monitor that is not needed any more to its end: what fails later, fails here."""
    _ = monitor.open, monitor.verdicts
    due = monitor.next_due
    later = 1 + max(monitor._last or 0, monitor._reached or 0)
    # What a monitor refuses for a reason of its own, it may refuse later.
    with suppress(TraceError):
        monitor.step_ns(later, dict.fromkeys(monitor.choice.compiled.checked.signals))
        monitor.step_ns(max(later + 1, due or 0), {})
    monitor.snapshot()
    monitor.finish_ns()


def _restored(compiled: CompiledSpec, document: Mapping[str, Any]) -> Monitor:
    monitor = build_monitor(
        compiled,
        only=document["only"],
        engine=document["engine"],
        settle=document["settle"],
        sources=document["sources"],
        keep=document["keep"],
    )
    choice = monitor.choice
    if document["machines"] != [_machine(one, choice.engine) for one in choice.requirements]:
        raise SnapshotError("the snapshot was made with other automata: was rvmon changed?")
    thawer = Thawer(_plans(compiled))
    monitor.lanes.rebuild(thawer.thaw(document["lanes"]))
    thawer.into(monitor, document["state"])
    for instant in (monitor._last, monitor._reached, monitor._torn):
        if instant is not None:
            whole_ticks(instant)
    moved: dict[str, list[int]] = {}
    for name, judge, machine in _progressing(monitor):
        if name not in moved:
            moved[name] = machine.learn(document["locations"][name])
        for attempt in judge.attempts:
            attempt.token = (moved[name][attempt.token[0]], attempt.token[1])
            if attempt.better is not None:
                attempt.better = (moved[name][attempt.better[0]], attempt.better[1])
    return monitor


def _document(data: bytes) -> Mapping[str, Any]:
    if not isinstance(data, bytes | bytearray | memoryview):
        raise SnapshotError(f"expected the bytes of a snapshot, found {type(data).__name__}")
    head, found, body = bytes(data).partition(b"\n")
    kind, _, checksum = head.rpartition(b" ")
    if kind != _KIND or not found:
        raise SnapshotError("these bytes are no snapshot of a monitor")
    if hashlib.sha256(body).hexdigest().encode() != checksum:
        raise SnapshotError("the snapshot is damaged: its checksum is not that of what it holds")
    try:
        document = json.loads(body)
    except (ValueError, RecursionError):
        document = None
    if not isinstance(document, dict):
        raise SnapshotError("the snapshot is damaged: it holds no document")
    return document


@cache
def _version() -> str:
    """The version of this package and of the law; kept, as it takes longer than all else here."""
    return f"{version('rvmon')}, law {LAW}"


def _digest_of(compiled: CompiledSpec) -> str:
    """See `digest`; worked out once for a compiled specification."""
    found = compiled.forms.get("digest")
    if not isinstance(found, str):
        found = compiled.forms["digest"] = digest(compiled.checked)
    return found


def digest(checked: CheckedSpec) -> str:
    """A hash of what a specification judges; its layout and its comments are no part of it."""
    return hashlib.sha256("\n".join(_said(checked)).encode()).hexdigest()


def _said(value: Any) -> Iterator[str]:
    """A specification in a form that is the same in every process."""
    if is_dataclass(value):
        yield type(value).__name__
        for field in fields(value):
            if field.name not in _UNSAID:
                yield from _said(getattr(value, field.name))
    elif isinstance(value, Enum):
        yield f"{type(value).__name__}.{value.name}"
    elif isinstance(value, Mapping):
        yield f"{{{len(value)}"
        for key, one in value.items():
            yield repr(key)
            yield from _said(one)
    elif isinstance(value, tuple | list):
        yield f"[{len(value)}"
        for one in value:
            yield from _said(one)
    elif isinstance(value, frozenset):
        yield from sorted(repr(one) for one in value)
    else:
        yield repr(value)


def _progressing(monitor: Monitor) -> Iterator[tuple[str, Judge, Progression]]:
    """The judges whose locations are numbered as they are met, and the name of what they judge."""
    names = {id(one): name for name, one in _judged(monitor.choice.compiled)}
    for lane in monitor.lanes.all:
        for judge in lane.judges:
            if isinstance(judge, Judge) and isinstance(judge.machine, Progression):
                yield names[id(judge.compiled)], judge, judge.machine


def _machine(compiled: CompiledRequirement, engine: str) -> str:
    """Which engine judges a requirement; for an automaton, a hash of its tables."""
    automaton = compiled.automaton
    if compiled.engine(engine) != "automaton" or automaton is None:
        return compiled.engine(engine)
    tables = (automaton.initial, automaton.bases, automaton.strides, automaton.targets)
    cuts = tuple(location.cuts for location in automaton.locations)
    said = repr((tables, automaton.edges.tolist(), automaton.sources, cuts))
    return hashlib.sha256(said.encode()).hexdigest()


def _plans(compiled: CompiledSpec) -> Mapping[str, Plan]:
    """The plans of networks."""
    return {name: one.network_plan for name, one in _judged(compiled)}


def _judged(compiled: CompiledSpec) -> Iterator[tuple[str, CompiledRequirement]]:
    """What is judged by name, for attempts in doubt behind their requirement's."""
    for name, one in compiled.requirements.items():
        for kind, judged in one.judges.items():
            yield name + kind, judged
