"""A run taken up again from a snapshot of it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from rvmon.errors import SnapshotError, TraceError
from rvmon.monitor.build import build_monitor
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.monitor import Monitor
from rvmon.monitor.online.snapshot import document_of
from rvmon.trace.time import whole_ticks


def restore(compiled: CompiledSpec, data: bytes) -> Monitor:
    """The monitor that a snapshot was taken of.

    Raises:
        SnapshotError: the bytes are no snapshot, or one of another specification or version.
    """
    document = document_of(compiled, data)
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
        monitor.step_ns(later, dict.fromkeys(monitor.options.compiled.checked.signals))
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
    monitor.take_up(document)
    for instant in (monitor._last, monitor._reached, monitor._torn):
        if instant is not None:
            whole_ticks(instant)
    return monitor
