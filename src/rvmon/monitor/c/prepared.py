"""What was compiled ahead for the engine `auto`, as the cache has it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rvmon.codegen.c_build import Build, built
from rvmon.codegen.c_online import Core, OnlineLibrary, library_of, online_build, type_in
from rvmon.monitor.c.beside import Beside, LendingMonitor, beside, plan_beside
from rvmon.monitor.c.notes import BESIDE, MEASURING, key_of, note, noted
from rvmon.monitor.compiled.code_plan import plan_alone, plan_requirements
from rvmon.monitor.compiled.refusal import of_prepared, of_prepared_margins
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.forms import Forms
from rvmon.plan.plan import Plan


@dataclass(frozen=True, slots=True)
class PreparedBeside:
    """What was compiled ahead to stand beside generated Python.

    Attributes:
        library: compiled, of the requirements that it judges.
        left: ids of those that generated Python judges.
    """

    library: OnlineLibrary
    left: frozenset[str]


def prepare_beside(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Path | None:
    """Compile what the engine `auto` takes, and note where it lies; `None`: it would take nothing.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.

    Raises:
        RvmonError: there is no compiler or no cache.
    """
    taken = taken_of(chosen)
    if not taken:
        return None
    build = online_build(plan_beside(plan_requirements(compiled, taken), taken), beside=True)
    return _built(BESIDE, build, compiled, chosen, taken)


def prepare_measuring(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Path:
    """Compile what measures robustness, and note where it lies.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.

    Raises:
        RvmonError: there is no compiler or no cache, or C does not measure a requirement.
    """
    build = online_build(_measured_plan(compiled, chosen), measured=True)
    return _built(MEASURING, build, compiled, chosen, chosen)


def _measured_plan(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Plan:
    return plan_alone(compiled, [one.requirement.id for one in chosen], measured=True)


def _built(
    use: str,
    build: Build,
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    taken: Sequence[CompiledRequirement],
) -> Path:
    """Compile, and note where it lies, and what of it is judged."""
    path = built(build)
    note(use, path, compiled, chosen, taken)
    return path


def taken_of(chosen: Sequence[CompiledRequirement]) -> Sequence[CompiledRequirement]:
    """Those of some requirements that `auto` has compiled C judge."""
    return [one for one in chosen if of_prepared(one) is None]


def prepared_beside(
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
) -> PreparedBeside | None:
    """What was compiled ahead for the engine `auto` in streams; `None`: nothing was.

    Args:
        compiled: the specification.
        chosen: the requirements.
        sources: the names that can arrive; `None`: all.
    """
    key = key_of(BESIDE, chosen)
    if key not in compiled.forms:
        found = _type(BESIDE, compiled, chosen)
        compiled.forms[key] = found and _prepared(compiled, chosen, *found)
    own = compiled.forms[key]
    if not isinstance(own, PreparedBeside):
        return None
    taken = (rule.requirement.id for rule in own.library.plan.rules)
    if sources is not None and not all(
        compiled.requirements[id_].reads <= sources for id_ in taken
    ):
        return None
    return own


def _prepared(
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    type_: Callable[..., Core],
    ids: Sequence[str],
) -> PreparedBeside:
    taken = [one for one in chosen if one.requirement.id in ids]
    plan = plan_beside(plan_requirements(compiled, taken), taken)
    left = frozenset(one.requirement.id for one in chosen if one.is_fed) - {*ids}
    return PreparedBeside(library_of(plan, type_), left)


def lending_monitor(
    prepared: PreparedBeside,
    forms: Forms,
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
    keep: int | None,
) -> LendingMonitor:
    """A monitor of the engine `auto` that has what was compiled ahead.

    Args:
        prepared: that.
        forms: generated in Python of what that judges, and what it does not.
        compiled: the specification.
        chosen: all requirements.
        sources: the names that can arrive; `None`: all.
        keep: see `build_monitor`.
    """
    key = ("beside", forms.unit)
    own = compiled.forms.get(key)
    if not isinstance(own, Beside):
        own = compiled.forms[key] = beside(forms, prepared.library)
    return LendingMonitor(own, forms, compiled, chosen, "auto", sources, keep)


def measuring_prepared(
    compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> OnlineLibrary | None:
    """What was compiled ahead to measure, for the engine `auto`; `None`: nothing was.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.
    """
    if not chosen or any(map(of_prepared_margins, chosen)):
        return None
    key = key_of(MEASURING, chosen)
    if key not in compiled.forms:
        found = _type(MEASURING, compiled, chosen)
        compiled.forms[key] = found and library_of(_measured_plan(compiled, chosen), found[0])
    own = compiled.forms[key]
    return own if isinstance(own, OnlineLibrary) else None


def _type(
    use: str, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> tuple[Callable[..., Core], Sequence[str]] | None:
    """The type that was compiled ahead, and ids of what it judges."""
    found = noted(use, compiled, chosen)
    if found is None:
        return None
    path, ids = found
    try:
        return type_in(path), ids
    except (OSError, ImportError):  # of another machine that shares the folder
        return None
