"""The monitor of a specification, made anew or from a snapshot."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.errors import RvmonError, SnapshotError, UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.monitor import Monitor
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.core.snapshot import Options, document_of
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.spec.checked.selection import requirements_asked


def build_monitor(
    compiled: CompiledSpec,
    *,
    only: Iterable[str] | None = None,
    settle: str = "now",
    sources: Iterable[str] | None = None,
    keep: int | None = None,
) -> Monitor:
    """Build a monitor from a compiled specification.

    Args:
        compiled: from `compile_spec`; any number of monitors can share it.
        only: ids of the requirements to judge; default all.
        settle: `now` judges each sample at once; `next` merges samples with equal stamps and judges
            each when the next stamp settles it.
        sources: the signals and events that can arrive; the others are unknown throughout.
        keep: so many records of each verdict, the newest, are kept per requirement; default all.

    Raises:
        UnknownNameError: `only` or `settle` names what does not exist.
        RvmonError: a requirement is beyond the core; `keep` is no count.
    """
    if keep is not None and (type(keep) is not int or keep < 0):
        raise RvmonError(f"keep={keep!r}: expected a whole number from 0 on, or None to keep all")
    if settle not in WAYS_TO_SETTLE:
        ways = ", ".join(WAYS_TO_SETTLE)
        raise UnknownNameError(f"no way to settle `{settle}`: there are {ways}")
    given = None if sources is None else frozenset(sources)
    planned = planned_core(compiled, requirements_asked(compiled.checked, only))
    return Monitor(planned, compiled, Options(settle, given, keep))


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
