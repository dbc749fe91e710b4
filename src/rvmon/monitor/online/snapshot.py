"""The state of a run as bytes, and put back into a run of the same shape.

The format is one line (kind, checksum) and JSON. It is checked before anything is taken from it,
and nothing in it is executed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from typing import TYPE_CHECKING, Any

from rvmon.automaton.progression import Progression
from rvmon.errors import SnapshotError
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.freeze import Freezer, Thawer
from rvmon.monitor.online.options import Options
from rvmon.verdict.verdict import LAW

if TYPE_CHECKING:
    from rvmon.dataflow.nodes import NetworkPlan
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.spec.checked.specification import CheckedSpec

_KIND = b"rvmon snapshot 2"

_LEFT_OUT = ("span", "source", "text", "title", "doc")
"""Fields of a specification that do not change what is judged."""


def snapshot(options: Options, evaluators: Evaluators, run: object) -> bytes:
    """The bytes of a run."""
    document = {
        **heading(options, [one.requirement.id for one in options.requirements]),
        "machines": _machines(options),
        "locations": {
            name: machine.table() for name, _, machine in _progressing(options, evaluators)
        },
    }
    freezer = Freezer(_plans(options.compiled))
    document["evaluators"] = freezer.freeze(evaluators.shape())
    document["state"] = freezer.freeze(run)
    return sealed(document)


def heading(options: Options, only: Sequence[str]) -> dict[str, Any]:
    """What a snapshot says of its monitor, which judges the requirements `only`."""
    return {
        "rvmon": _version(),
        "spec": digest_of(options.compiled),
        "only": [*only],
        "engine": options.engine,
        "settle": options.settle,
        "sources": None if options.sources is None else sorted(options.sources),
        "keep": options.keep,
    }


def sealed(document: Mapping[str, Any]) -> bytes:
    """The bytes of a document, which `document_of` reads."""
    body = json.dumps(document, separators=(",", ":")).encode()
    return b"%s %s\n%s" % (_KIND, hashlib.sha256(body).hexdigest().encode(), body)


def document_of(compiled: CompiledSpec, data: bytes) -> Mapping[str, Any]:
    """What a snapshot says; `only`, `engine`, `settle`, `sources` and `keep` are of its monitor.

    Raises:
        SnapshotError: the bytes are no snapshot, or one of another specification or version.
    """
    document = _document(data)
    if document.get("rvmon") != _version():
        raise SnapshotError(
            f"the snapshot was made by rvmon {document.get('rvmon')}, this is {_version()}: "
            "restore it with the version that made it"
        )
    if document.get("spec") != digest_of(compiled):
        raise SnapshotError(
            f"the snapshot was made with another specification than `{compiled.checked.name}`: "
            "load the one it was made with, with the same constants"
        )
    return document


def put_back(
    document: Mapping[str, Any], options: Options, evaluators: Evaluators, run: object
) -> None:
    """Give a fresh run the state that a snapshot holds.

    Raises:
        SnapshotError: the requirements were judged by other automata.
    """
    if document["machines"] != _machines(options):
        raise SnapshotError("the snapshot was made with other automata: was rvmon changed?")
    thawer = Thawer(_plans(options.compiled))
    evaluators.rebuild(thawer.thaw(document["evaluators"]))
    thawer.into(run, document["state"])
    moved: dict[str, list[int]] = {}
    for name, judge, machine in _progressing(options, evaluators):
        if name not in moved:
            moved[name] = machine.learn(document["locations"][name])
        for attempt in judge.attempts:
            attempt.token = (moved[name][attempt.token[0]], attempt.token[1])
            if attempt.better is not None:
                attempt.better = (moved[name][attempt.better[0]], attempt.better[1])


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
    from importlib.metadata import version

    return f"{version('rvmon')}, law {LAW}"


def digest_of(compiled: CompiledSpec) -> str:
    """See `digest`; worked out once for a compiled specification."""
    found = compiled.forms.get("digest")
    if not isinstance(found, str):
        found = compiled.forms["digest"] = digest(compiled.checked)
    return found


def digest(checked: CheckedSpec) -> str:
    """A hash of what a specification judges; its layout and its comments are no part of it."""
    return hashlib.sha256("\n".join(_fingerprint(checked)).encode()).hexdigest()


def _fingerprint(value: Any) -> Iterator[str]:
    """A specification in a form that is the same in every process."""
    if is_dataclass(value):
        yield type(value).__name__
        for field in fields(value):
            if field.name not in _LEFT_OUT:
                yield from _fingerprint(getattr(value, field.name))
    elif isinstance(value, Enum):
        yield f"{type(value).__name__}.{value.name}"
    elif isinstance(value, Mapping):
        yield f"{{{len(value)}"
        for key, one in value.items():
            yield repr(key)
            yield from _fingerprint(one)
    elif isinstance(value, tuple | list):
        yield f"[{len(value)}"
        for one in value:
            yield from _fingerprint(one)
    elif isinstance(value, frozenset):
        yield from sorted(repr(one) for one in value)
    else:
        yield repr(value)


def _progressing(
    options: Options, evaluators: Evaluators
) -> Iterator[tuple[str, MachineJudge, Progression]]:
    """The judges whose locations are numbered as they are met, and the name of what they judge."""
    names = {id(one): name for name, one in _judged(options.compiled)}
    for evaluator in evaluators.all:
        for judge in evaluator.judges:
            if isinstance(judge, MachineJudge) and isinstance(judge.machine, Progression):
                yield names[id(judge.compiled)], judge, judge.machine


def _machines(options: Options) -> list[str]:
    return [_machine(one, options.engine) for one in options.requirements]


def _machine(compiled: CompiledRequirement, engine: str) -> str:
    """Which engine judges a requirement; for an automaton, a hash of its tables."""
    automaton = compiled.automaton
    if compiled.engine(engine) != "automaton" or automaton is None:
        return compiled.engine(engine)
    tables = (automaton.initial, automaton.bases, automaton.strides, automaton.targets)
    cuts = tuple(location.cuts for location in automaton.locations)
    content = repr((tables, automaton.edges.tolist(), automaton.sources, cuts))
    return hashlib.sha256(content.encode()).hexdigest()


def _plans(compiled: CompiledSpec) -> Mapping[str, NetworkPlan]:
    """The plans of networks."""
    return {name: one.network_plan for name, one in _judged(compiled)}


def _judged(compiled: CompiledSpec) -> Iterator[tuple[str, CompiledRequirement]]:
    """What is judged by name, for attempts in doubt behind their requirement's."""
    for name, one in compiled.requirements.items():
        for kind, judged in one.judges.items():
            yield name + kind, judged
