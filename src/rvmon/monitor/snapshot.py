"""Writes the state of a run as a snapshot, and restores it.

The format is one line (kind, SHA-256) and a JSON document that holds the bytes of the core in
base64. The checksum is verified before anything is read, and nothing is executed.
"""

from __future__ import annotations

import hashlib
import json
from base64 import b64decode, b64encode
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from rvmon import native
from rvmon.errors import SnapshotError
from rvmon.language.checked.serialise import identity_text
from rvmon.monitor.packed_plan import PlannedCore
from rvmon.verdicts import LAW

if TYPE_CHECKING:
    from rvmon.language.checked.specification import CheckedSpec
    from rvmon.monitor.compiled_spec import CompiledSpec

_KIND = b"rvmon snapshot 3"

_LEFT_OUT = ("text", "title", "doc")
"""Fields of a specification that do not affect verdicts, left out of its hash."""


class Options(Struct, frozen=True):
    """The options of a monitor; see `rvmon.monitor.monitor.build_monitor`."""

    settle: str
    sources: frozenset[str] | None
    keep: int | None


def snapshot_of(
    compiled: CompiledSpec,
    options: Options,
    planned: PlannedCore,
    run: native.Monitor,
    state: Mapping[str, Any],
) -> bytes:
    """The snapshot of a run, as bytes; `state` is the part held in Python, as JSON values."""
    document = {
        "rvmon": _version(), "spec": digest_of(compiled), "only": [*planned.packed.ids],
        "settle": options.settle,
        "sources": None if options.sources is None else sorted(options.sources),
        "keep": options.keep, "plan": _digest(planned), "core": _text(run.save()),
        "arrivals": _text(run.arrivals()), "state": state,
    }  # fmt: skip
    body = json.dumps(document, separators=(",", ":")).encode()
    return b"%s %s\n%s" % (_KIND, hashlib.sha256(body).hexdigest().encode(), body)


def document_of(compiled: CompiledSpec, data: bytes) -> Mapping[str, Any]:
    """Check a snapshot and parse it; `only`, `settle`, `sources` and `keep` are its options.

    Raises:
        SnapshotError: the bytes are not a snapshot, or one of another specification or version.
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


def restored_state(
    document: Mapping[str, Any], planned: PlannedCore, run: native.Monitor
) -> Mapping[str, Any]:
    """Restore the core's state in a fresh run; returns the state held in Python.

    Raises:
        SnapshotError: the snapshot was made with another plan, or its bytes are not a state of it.
    """
    if document["plan"] != _digest(planned):
        raise SnapshotError("the snapshot was made with another plan: was rvmon changed?")
    if not (run.load(_bytes(document["core"])) and run.take_arrivals(_bytes(document["arrivals"]))):
        raise SnapshotError("the snapshot is damaged: its content is not a run of its plan")
    state: Mapping[str, Any] = document["state"]
    return state


def _text(data: bytes) -> str:
    return b64encode(data).decode("ascii")


def _bytes(text: Any) -> bytes:
    return b64decode(text, validate=True)


def _digest(planned: PlannedCore) -> str:
    return hashlib.sha256(planned.packed.data).hexdigest()


def _document(data: bytes) -> Mapping[str, Any]:
    if not isinstance(data, bytes | bytearray | memoryview):
        raise SnapshotError(f"expected the bytes of a snapshot, found {type(data).__name__}")
    head, separator, body = bytes(data).partition(b"\n")
    kind, _, checksum = head.rpartition(b" ")
    if kind != _KIND or not separator:
        raise SnapshotError("these bytes are not a snapshot of a monitor")
    if hashlib.sha256(body).hexdigest().encode() != checksum:
        raise SnapshotError("the snapshot is damaged: its checksum does not match its content")
    try:
        document = json.loads(body)
    except (ValueError, RecursionError):
        document = None
    if not isinstance(document, dict):
        raise SnapshotError("the snapshot is damaged: it holds no document")
    return document


@cache
def _version() -> str:
    """The version of this package and of the semantics; cached, as looking it up is slow."""
    from importlib.metadata import version

    return f"{version('rvmon')}, law {LAW}"


def digest_of(compiled: CompiledSpec) -> str:
    """`digest` of a compiled specification, computed once."""
    digest_ = compiled.forms.get("digest")
    if not isinstance(digest_, str):
        digest_ = compiled.forms["digest"] = digest(compiled.checked)
    return digest_


def digest(checked: CheckedSpec) -> str:
    """A hash of the meaning of a specification, independent of its layout and comments."""
    return hashlib.sha256(identity_text(checked, without=_LEFT_OUT).encode()).hexdigest()
