"""What was compiled ahead for the engine `auto`, as the cache has it."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from rvmon.cache import cache_folder, file_stamps, is_whole, keep, read_kept
from rvmon.codegen.c_build import Build, built, processor
from rvmon.codegen.c_online import Core, OnlineLibrary, library_of, online_build, type_in
from rvmon.monitor.c.beside import Beside, LendingMonitor, beside, plan_beside
from rvmon.monitor.compiled.code_plan import plan_alone, plan_requirements
from rvmon.monitor.compiled.refusal import of_prepared, of_prepared_margins
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.generated import Forms
from rvmon.monitor.online.snapshot import digest_of
from rvmon.plan.plan import Plan

_BESIDE, _MEASURING = "beside", "measuring"
"""What a file is for."""

_PACKAGE = Path(__file__).parents[2]


def prepare_beside(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Path | None:
    """Compile what the engine `auto` takes, and note where it lies; `None`: it would take nothing.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.

    Raises:
        RvmonError: there is no compiler or no cache.
    """
    if not is_taken(chosen):
        return None
    build = online_build(plan_beside(plan_requirements(compiled, chosen)), beside=True)
    return _built(_BESIDE, build, compiled, chosen)


def prepare_measuring(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Path:
    """Compile what measures robustness, and note where it lies.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.

    Raises:
        RvmonError: there is no compiler or no cache, or C does not measure a requirement.
    """
    build = online_build(_measured_plan(compiled, chosen), measured=True)
    return _built(_MEASURING, build, compiled, chosen)


def _measured_plan(compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Plan:
    return plan_alone(compiled, [one.requirement.id for one in chosen], measured=True)


def _built(
    use: str, build: Build, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> Path:
    """Compile, and note where it lies."""
    path = built(build)
    keep(_note(use, path.parent, compiled, chosen), json.dumps([_maker(), path.name]).encode())
    compiled.forms.pop(_key(use, chosen), None)
    return path


def is_taken(chosen: Sequence[CompiledRequirement]) -> bool:
    """Whether `auto` takes what is compiled for some requirements: all of them or none."""
    return bool(chosen) and all(of_prepared(one) is None for one in chosen)


def lending_monitor(
    compiled: CompiledSpec,
    forms: Forms,
    sources: frozenset[str] | None,
    keep: int | None,
) -> LendingMonitor | None:
    """A monitor of the engine `auto` that has what was compiled ahead; `None`: nothing was.

    Args:
        compiled: the specification.
        forms: what was generated in Python of the requirements.
        sources: the names that can arrive; `None`: all.
        keep: see `build_monitor`.
    """
    chosen = forms.requirements
    if forms.others or not _has_gil():
        return None
    if sources is not None and not all(one.reads <= sources for one in chosen):
        return None
    key = _key(_BESIDE, chosen)
    if key not in compiled.forms:
        type_ = _type(_BESIDE, compiled, chosen)
        compiled.forms[key] = type_ and beside(forms, library_of(plan_beside(forms.plan), type_))
    own = compiled.forms[key]
    if not isinstance(own, Beside):
        return None
    return LendingMonitor(own, forms, compiled, chosen, "auto", sources, keep)


def measuring_prepared(
    compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> OnlineLibrary | None:
    """What was compiled ahead to measure, for the engine `auto`; `None`: nothing was.

    Args:
        compiled: the specification.
        chosen: the requirements, from it.
    """
    if not chosen or not _has_gil() or any(map(of_prepared_margins, chosen)):
        return None
    key = _key(_MEASURING, chosen)
    if key not in compiled.forms:
        type_ = _type(_MEASURING, compiled, chosen)
        compiled.forms[key] = type_ and library_of(_measured_plan(compiled, chosen), type_)
    own = compiled.forms[key]
    return own if isinstance(own, OnlineLibrary) else None


def _has_gil() -> bool:
    return bool(getattr(sys, "_is_gil_enabled", lambda: True)())


def _type(
    use: str, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> Callable[..., Core] | None:
    """The type that was compiled ahead."""
    folder = cache_folder()
    note = None if folder is None else read_kept(_note(use, folder, compiled, chosen))
    if folder is None or note is None:
        return None
    try:
        maker, name = json.loads(note)
    except ValueError:
        return None
    path = folder / Path(name).name
    if maker != _maker() or not is_whole(path):
        return None
    try:
        return type_in(path)
    except (OSError, ImportError):  # of another machine that shares the folder
        return None


def _key(use: str, chosen: Sequence[CompiledRequirement]) -> tuple[object, ...]:
    return (use, *(one.requirement.id for one in chosen))


def _note(
    use: str, folder: Path, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]
) -> Path:
    """Where it stands which file was made of some requirements."""
    key = (digest_of(compiled), [one.requirement.id for one in chosen])
    return folder / f"{use}-{hashlib.sha256(repr(key).encode()).hexdigest()[:40]}.json"


@cache
def _maker() -> str:
    """What else a file depends on: this package, this Python, this processor."""
    key = (list(file_stamps(str(_PACKAGE))), sys.version, processor())
    return hashlib.sha256(repr(key).encode()).hexdigest()
