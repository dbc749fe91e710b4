"""The monitor of a specification."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.errors import RvmonError, UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.monitor import Monitor
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.core.snapshot import Options
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
