"""What was compiled ahead to stand beside generated Python, as the cache has it."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from rvmon.cache import cache_folder, file_stamps, is_whole, keep, read_kept
from rvmon.codegen.c_build import built, processor
from rvmon.codegen.c_online import library_of, online_build, type_in
from rvmon.monitor.c.beside import Beside, LendingMonitor, beside, plan_beside
from rvmon.monitor.compiled.code_plan import plan_requirements
from rvmon.monitor.compiled.refusal import of_prepared
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.generated import Forms
from rvmon.monitor.online.snapshot import digest_of

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
    path = built(online_build(plan_beside(plan_requirements(compiled, chosen)), beside=True))
    keep(_note(path.parent, compiled, chosen), json.dumps([_maker(), path.name]).encode())
    compiled.forms.pop(_key(chosen), None)
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
    if forms.others or not getattr(sys, "_is_gil_enabled", lambda: True)():
        return None
    if sources is not None and not all(one.reads <= sources for one in chosen):
        return None
    key = _key(chosen)
    if key not in compiled.forms:
        compiled.forms[key] = _found(compiled, forms)
    own = compiled.forms[key]
    if not isinstance(own, Beside):
        return None
    return LendingMonitor(own, forms, compiled, chosen, "auto", sources, keep)


def _found(compiled: CompiledSpec, forms: Forms) -> Beside | None:
    folder = cache_folder()
    note = None if folder is None else read_kept(_note(folder, compiled, forms.requirements))
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
        type_ = type_in(path)
    except (OSError, ImportError):  # of another machine that shares the folder
        return None
    return beside(forms, library_of(plan_beside(forms.plan), type_))


def _key(chosen: Sequence[CompiledRequirement]) -> tuple[object, ...]:
    return ("beside", *(one.requirement.id for one in chosen))


def _note(folder: Path, compiled: CompiledSpec, chosen: Sequence[CompiledRequirement]) -> Path:
    """Where it stands which file was made of some requirements."""
    said = (digest_of(compiled), [one.requirement.id for one in chosen])
    return folder / f"beside-{hashlib.sha256(repr(said).encode()).hexdigest()[:40]}.json"


@cache
def _maker() -> str:
    """What else a file depends on: this package, this Python, this processor."""
    said = (list(file_stamps(str(_PACKAGE))), sys.version, processor())
    return hashlib.sha256(repr(said).encode()).hexdigest()
