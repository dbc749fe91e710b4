"""The mutants of a campaign's code, made from its syntax tree."""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

from rvmon.cdv.mutation.python_operators import Scope, Strings, changes_of
from rvmon.cdv.system import Code
from rvmon.errors import RvmonError
from rvmon.texts import text_of_file

THIRDS = ("A", "B", "held out")
"""Mutants are divided into these by a hash of their identity; look only at the first two to improve
a suite.

The score on mutants that guided the improvement is biased; that on the held-out third is not.
"""

HELD_OUT = THIRDS[-1]


def third_of(identity: str) -> str:
    """The third to which an identity belongs.

    >>> third_of("R1:bound:1") in THIRDS
    True
    """
    return THIRDS[int.from_bytes(hashlib.sha256(identity.encode()).digest()) % len(THIRDS)]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one file."""

    path: Path  # the file
    line: int  # the changed line, from 1
    kind: str  # the name of the mutation operator
    before: str  # the original code
    after: str  # the changed code
    source: str  # the whole changed file
    function: str = ""  # qualified name of the changed function, or name of the changed constant
    ordinal: int = 0  # its number among the changes of this kind to this function, from 1

    @property
    def change(self) -> str:
        """File and change, without the line, so that it stays the same when the file grows."""
        return f"{self.path.name} {self.kind}: `{self.before}` => `{self.after}`"

    @property
    def brief(self) -> str:
        """The change on one line; code of several lines is cut to its first."""
        return f"{_first(self.before)} => {_first(self.after)}"

    @property
    def identity(self) -> str:
        """Its name in lists: file, function, kind and ordinal."""
        return f"{self.path.stem}:{self.function}:{self.kind}:{self.ordinal}".replace(" ", "-")

    @property
    def third(self) -> str:
        """The third to which it belongs, by its identity."""
        return third_of(self.identity)

    def __str__(self) -> str:
        return f"line {self.line:>3} of {self.change}"


def _first(code: str) -> str:
    first, *others = code.splitlines()
    return f"{first} …" if others else first


def mutants(
    path: Path, lines: Collection[int], *, constants: Collection[str] = ()
) -> Iterator[Mutant]:
    r"""All mutants of a file, inside functions and on given lines only.

    Args:
        path: the file, which is parsed but not run.
        lines: the lines to change.
        constants: names of module-level constants whose values are changed as well.

    Raises:
        RvmonError: the file cannot be read, or is not Python.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "near.py")
    ...     _ = path.write_text("def near(metres):\n    return metres < 2.0\n")
    ...     [one.after for one in mutants(path, {2})][:3]
    ['metres <= 2.0', 'return metres < (2.2)', 'return metres < (1.8)']
    """
    try:
        source = text_of_file(path)
        tree = ast.parse(source, filename=str(path))
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}") from None
    except (SyntaxError, ValueError) as error:
        raise RvmonError(f"{path}: not Python: {error}") from None
    strings = Strings(tree)
    ordinals: Counter[tuple[str, str]] = Counter()
    for name, body in _scopes(tree, "", constants):
        scope = Scope(body, strings)
        is_constant = name in constants
        for node in (node for statement in body for node in _mutable_nodes(statement)):
            if not isinstance(node, ast.expr if is_constant else ast.expr | ast.stmt):
                continue
            if is_constant or node.lineno in lines:
                for kind, before, after, text in _changes(source, node, scope):
                    ordinals[name, kind] += 1
                    at, ordinal = node.lineno, ordinals[name, kind]
                    yield Mutant(path, at, kind, before, after, text, name, ordinal)


def _scopes(
    tree: ast.AST, prefix: str, constants: Collection[str]
) -> Iterator[tuple[str, list[ast.stmt]]]:
    """The name and body of each function, nested ones included, and of each named constant."""
    for node in ast.iter_child_nodes(tree):
        match node:
            case ast.FunctionDef(name=name, body=body) | ast.AsyncFunctionDef(name=name, body=body):
                yield f"{prefix}{name}", body
                yield from _scopes(node, f"{prefix}{name}.<locals>.", ())
            case ast.ClassDef(name=name):
                yield from _scopes(node, f"{prefix}{name}.", ())
            case ast.Assign(targets=[ast.Name(id=name)]) if name in constants:
                yield name, [node]
            case _:
                yield from _scopes(node, prefix, ())


def _mutable_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """The node and all below it whose change could matter, except nested functions.

    Those are scopes of their own. Annotations do not matter, nor does `strict` of `zip`.
    """
    yield node
    for name, field in ast.iter_fields(node):
        if name in ("annotation", "returns") or getattr(node, "arg", "") == "strict":
            continue
        for child in field if isinstance(field, list) else [field]:
            if isinstance(child, ast.AST) and not isinstance(
                child, ast.FunctionDef | ast.AsyncFunctionDef
            ):
                yield from _mutable_nodes(child)


def _changes(
    source: str, node: ast.expr | ast.stmt, scope: Scope
) -> Iterator[tuple[str, str, str, str]]:
    """All changes to a node, each as kind, code before, code after, and changed file."""
    for kind, target, text in changes_of(node, scope):
        before, after = ast.unparse(target), ast.unparse(ast.parse(text))
        if before == after:
            continue
        changed = _replaced(source, target, text)
        if isinstance(target, ast.Constant | ast.Set):
            # A constant means nothing on its own, so show its line.
            before, after = (
                code.splitlines()[target.lineno - 1].strip() for code in (source, changed)
            )
        yield kind, before, after, changed


def _replaced(source: str, node: ast.expr | ast.stmt, text: str) -> str:
    """The source with the text of a node replaced; columns of `ast` count UTF-8 bytes."""
    lines = source.encode().splitlines(keepends=True)
    end_line, end_column = node.end_lineno or node.lineno, node.end_col_offset or 0
    before = b"".join(lines[: node.lineno - 1]) + lines[node.lineno - 1][: node.col_offset]
    after = lines[end_line - 1][end_column:] + b"".join(lines[end_line:])
    return (before + text.encode() + after).decode()


def code_mutants(code: Code) -> list[Mutant]:
    """All mutants of the measured code and its constants, in the order of files and lines.

    Mutants that Python compiles to the same bytecode as the original or as an earlier mutant are
    left out, and so are those that do not compile.

    Raises:
        RvmonError: a file cannot be read, or is not Python.

    Source: Papadakis, Jia, Harman, Le Traon 2015, Trivial Compiler Equivalence.
    """
    kept = []
    lines: dict[str, set[int]] = {path: set() for path in code.constants}
    for block in code.blocks:
        lines.setdefault(block.path, set()).update(block.lines)
    for path, measured in lines.items():
        known = {_bytecode(compile(text_of_file(path), path, "exec"))}
        changes = mutants(Path(path), measured, constants=code.constants.get(path, ()))
        for mutant in sorted(changes, key=lambda mutant: mutant.line):
            meaning = _bytecode_of(mutant)
            if meaning is not None and meaning not in known:
                known.add(meaning)
                kept.append(mutant)
    return kept


def _bytecode_of(mutant: Mutant) -> tuple[object, ...] | None:
    try:
        return _bytecode(compile(mutant.source, str(mutant.path), "exec"))
    except (SyntaxError, ValueError):
        return None


def _bytecode(code: CodeType) -> tuple[object, ...]:
    """What determines the behaviour of a code object, without its line numbers."""
    return code.co_name, code.co_code, code.co_names, code.co_varnames, tuple(_constants(code))


def _constants(code: CodeType) -> Iterator[object]:
    for const in code.co_consts:
        if isinstance(const, CodeType):
            yield _bytecode(const)
        else:
            yield type(const).__name__, repr(const)
