"""Plant a mutant into this process: what runs from then on runs the changed code.

Functions that are loaded get the changed code in their place, so that it does not matter who holds
them; a constant is worked out anew, with what follows from it; a file that is not loaded yet will
be loaded with the change. Nothing is undone: the process is to be ended afterwards.
"""

from __future__ import annotations

import ast
import gc
import os
import sys
from collections.abc import Iterator
from importlib.machinery import SourceFileLoader
from types import CodeType, FunctionType, ModuleType

from rvmon.cdv.mutation.mutant import Mutant
from rvmon.errors import RvmonError


def plant(mutant: Mutant, source: str) -> None:
    """Change the code of this process.

    Args:
        mutant: what is to run.
        source: of its file as it was.

    Raises:
        RvmonError: it cannot be planted; the message says why.
    """
    path = os.path.abspath(mutant.path)
    changed = compile(mutant.source, path, "exec")
    _change_loader(path, changed)
    modules = [one for one in list(sys.modules.values()) if _path_of(one) == path]
    if not modules:
        return
    known = _functions(compile(source, path, "exec"), mutant.function)
    if known:
        _change_functions(path, known, _functions(changed, mutant.function))
    else:
        for module in modules:
            _change_constants(module, mutant)


def _path_of(module: ModuleType) -> str | None:
    path = getattr(module, "__file__", None)
    return os.path.abspath(path) if path else None


def _change_loader(path: str, changed: CodeType) -> None:
    known = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, name: str) -> CodeType | None:
        return changed if os.path.abspath(self.path) == path else known(self, name)

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign,assignment]


def _functions(code: CodeType, name: str) -> list[CodeType]:
    """The functions of a qualified name in the order of the file: a property has up to three."""
    return [one for one in _all_codes(code) if one.co_qualname == name]


def _all_codes(code: CodeType) -> Iterator[CodeType]:
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield one
            yield from _all_codes(one)


def _change_functions(path: str, known: list[CodeType], changed: list[CodeType]) -> None:
    by_line = {old.co_firstlineno: new for old, new in zip(known, changed, strict=True)}
    for function in gc.get_objects():
        if not isinstance(function, FunctionType):
            continue
        code = function.__code__
        if code.co_qualname == known[0].co_qualname and os.path.abspath(code.co_filename) == path:
            try:
                function.__code__ = by_line[code.co_firstlineno]
            except (KeyError, ValueError) as error:
                raise RvmonError(f"`{code.co_qualname}` cannot be changed: {error}") from None


def _change_constants(module: ModuleType, mutant: Mutant) -> None:
    """Work out a constant, and the file's constants that are made of it, and bind them anew."""
    namespace = dict(vars(module))
    names = {mutant.function}
    for statement in ast.parse(mutant.source).body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                if name in names or names & _read(statement):
                    only = ast.Module([statement], [])
                    exec(compile(only, str(mutant.path), "exec"), namespace)  # noqa: S102
                    names.add(name)
    for name in names:
        old = getattr(module, name, None)
        for other in list(sys.modules.values()):
            if getattr(other, "__dict__", {}).get(name) is old:
                setattr(other, name, namespace[name])


def _read(statement: ast.stmt) -> set[str]:
    return {node.id for node in ast.walk(statement) if isinstance(node, ast.Name)}
