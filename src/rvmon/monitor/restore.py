"""A run taken up again from a snapshot of it."""

from __future__ import annotations

from rvmon.errors import RvmonError, SnapshotError
from rvmon.monitor.build import build_monitor
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.monitor import Monitor
from rvmon.monitor.core.snapshot import document_of


def restore(compiled: CompiledSpec, data: bytes) -> Monitor:
    """The monitor that a snapshot was taken of.

    Raises:
        SnapshotError: the bytes are no snapshot, or one of another specification or version.
    """
    document = document_of(compiled, data)
    try:
        sources = document["sources"]
        if sources is not None and not all(isinstance(one, str) for one in sources):
            raise TypeError("names are texts")
        monitor = build_monitor(
            compiled,
            only=document["only"],
            settle=document["settle"],
            sources=sources,
            keep=document["keep"],
        )
        monitor.take_up(document)
    except SnapshotError:
        raise
    except (RvmonError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        raise SnapshotError("the snapshot is damaged: what it holds fits no monitor") from None
    return monitor
