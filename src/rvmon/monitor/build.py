"""The choice of a monitor for a specification."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.errors import RvmonError, UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.monitor.online.monitor import Monitor
from rvmon.spec.checked.selection import requirements_asked


def build_monitor(
    compiled: CompiledSpec,
    *,
    only: Iterable[str] | None = None,
    engine: str = "auto",
    settle: str = "now",
    sources: Iterable[str] | None = None,
    keep: int | None = None,
) -> Monitor:
    """Build a monitor from a compiled specification.

    Args:
        compiled: from `compile_spec`; any number of monitors can share it.
        only: ids of the requirements to judge; default all.
        engine: the name of one; see `rvmon.monitor.engines`.
        settle: `now` judges each sample at once; `next` merges samples with equal stamps and judges
            each when the next stamp settles it.
        sources: the signals and events that can arrive; the others are unknown throughout.
        keep: so many records of each verdict, the newest, are kept per requirement; default all.

    Raises:
        UnknownNameError: `only`, `engine` or `settle` names what does not exist.
        RvmonError: the engine was asked for by name and cannot judge a requirement, or drop
            records; `keep` is no count.
    """
    if keep is not None and (type(keep) is not int or keep < 0):
        raise RvmonError(f"keep={keep!r}: expected a whole number from 0 on, or None to keep all")
    if settle not in ("now", "next"):
        raise UnknownNameError(f"no way to settle `{settle}`: there are now, next")
    given = None if sources is None else frozenset(sources)
    ids = requirements_asked(compiled.checked, only)
    return engine_named(engine).online(compiled, Asked(ids, settle, given, keep))
