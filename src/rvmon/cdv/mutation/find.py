"""The mutants of a campaign's code."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import CodeType

from rvmon.cdv.code import Code
from rvmon.cdv.mutation.mutant import Mutant
from rvmon.cdv.mutation.source import mutants
from rvmon.diagnostics.text_file import text_of_file


def code_mutants(code: Code) -> list[Mutant]:
    """All mutants of what is measured, and of its constants, in the order of files and lines.

    Of those that Python compiles to one code the first is kept, and none that it compiles to the
    code as it is, or not at all.

    Args:
        code: whose files are read and not run.

    Raises:
        RvmonError: one cannot be read, or is no Python.

    Source: Papadakis, Jia, Harman, Le Traon 2015, Trivial Compiler Equivalence.
    """
    found = []
    lines: dict[str, set[int]] = {path: set() for path in code.constants}
    for block in code.blocks:
        lines.setdefault(block.path, set()).update(block.lines)
    for path, own in lines.items():
        known = {_meaning(compile(text_of_file(path), path, "exec"))}
        made = mutants(Path(path), own, constants=code.constants.get(path, ()))
        for mutant in sorted(made, key=lambda one: one.line):
            meaning = _meaning_of(mutant)
            if meaning is not None and meaning not in known:
                known.add(meaning)
                found.append(mutant)
    return found


def _meaning_of(mutant: Mutant) -> tuple[object, ...] | None:
    try:
        return _meaning(compile(mutant.source, str(mutant.path), "exec"))
    except (SyntaxError, ValueError):
        return None


def _meaning(code: CodeType) -> tuple[object, ...]:
    """What code does, wherever it stands."""
    return code.co_name, code.co_code, code.co_names, code.co_varnames, tuple(_constants(code))


def _constants(code: CodeType) -> Iterator[object]:
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield _meaning(one)
        else:
            yield type(one).__name__, repr(one)
