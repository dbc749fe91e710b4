"""The choice of a monitor for a specification."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.errors import RvmonError, UnknownNameError
from rvmon.monitor.codegen_support import can_feed
from rvmon.monitor.compiled import ALL_ENGINES, CompiledSpec, expect_engine
from rvmon.monitor.generated import Forms, GeneratedMonitor
from rvmon.monitor.monitor import Monitor
from rvmon.spec.checked.selection import requirements_asked

_GENERATED = ("auto", "python")

_MOST_GENERATED = 2000
"""For more requirements no code is generated: it has a bit for each in numbers that it names."""


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
        engine: `auto` runs generated code where there is an automaton, else the delay network;
            `python`: the same; `automaton`, `network` and `progression` look up tables, take note
            of what becomes known, or work out residuals, at each step; `c` compiles the monitor,
            and gives records without reasons.
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
    wanted = requirements_asked(compiled.checked, only)
    chosen = [
        requirement
        for name, requirement in compiled.requirements.items()
        if wanted is None or name in wanted
    ]
    expect_engine(engine, ALL_ENGINES)
    given = None if sources is None else frozenset(sources)
    if engine == "c" and chosen:
        from rvmon.monitor.online_c import compiled_monitor

        if keep is not None:
            raise RvmonError("the engine `c` keeps all records: leave out `keep`, or use `auto`")
        return compiled_monitor(compiled, chosen, settle, given)
    for requirement in chosen:
        requirement.engine(engine)
    is_few = len(chosen) <= _MOST_GENERATED
    if engine == "python" and not is_few:
        raise RvmonError(
            f"error: {len(chosen)} requirements are more than the {_MOST_GENERATED} that generated "
            "code judges at once: use the engine `auto`, or several monitors (`only`)"
        )
    is_generated = engine in _GENERATED and is_few
    if not is_generated or not any(can_feed(one) for one in chosen):
        return Monitor(compiled, chosen, engine, settle, given, keep)
    key = (tuple(one.requirement.id for one in chosen), given)
    forms = compiled.forms.get(key)
    if not isinstance(forms, Forms):
        forms = compiled.forms[key] = Forms(compiled, chosen, given)
    return GeneratedMonitor(forms, compiled, chosen, engine, settle, given, keep)
