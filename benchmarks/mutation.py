"""Small wrong changes of a source file, found in its syntax tree."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one file.

    Attributes:
        path: the file.
        line: where, from 1.
        kind: of change, in a few words.
        before: the changed code as it was.
        after: as it is.
        source: the whole file as it is.
    """

    path: Path
    line: int
    kind: str
    before: str
    after: str
    source: str

    @property
    def change(self) -> str:
        """File and change, without the line: what it is known by when the file grows."""
        return f"{self.path.name} {self.kind}: `{self.before}` => `{self.after}`"

    def __str__(self) -> str:
        return f"line {self.line:>3} of {self.change}"


_COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
}
_FUNCTIONS = {"min": "max", "max": "min", "any": "all", "all": "any"}


def mutants(path: Path, lines: set[int]) -> Iterator[Mutant]:
    """All changes that are tried in a file, inside functions and on given lines only.

    Args:
        path: the file.
        lines: those that a test executes; a change elsewhere could not be seen.
    """
    source = path.read_text(encoding="utf-8")
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef):
            continue
        for statement in function.body:
            for node in _executed(statement):
                if getattr(node, "lineno", None) in lines:
                    yield from _mutants_at(path, source, node)


def _executed(node: ast.AST) -> Iterator[ast.AST]:
    """The node and all below it that can matter, but for functions: they are met by themselves.

    Annotations do not matter, nor whether `zip` looks at lengths that are equal.
    """
    yield node
    for name, field in ast.iter_fields(node):
        if name in ("annotation", "returns") or getattr(node, "arg", "") == "strict":
            continue
        for child in field if isinstance(field, list) else [field]:
            if isinstance(child, ast.AST) and not isinstance(child, ast.FunctionDef):
                yield from _executed(child)


def _mutants_at(path: Path, source: str, node: ast.AST) -> Iterator[Mutant]:
    for kind, target, new in _changes(node):
        before, after = ast.unparse(target), ast.unparse(new)
        if before != after:
            text = f"({after})" if isinstance(new, ast.expr) else after
            changed = _replaced(source, target, text)
            if isinstance(target, ast.Constant):
                # A constant says nothing by itself.
                before, after = (_line(code, target.lineno) for code in (source, changed))
            yield Mutant(path, target.lineno, kind, before, after, changed)


def _line(source: str, number: int) -> str:
    return source.splitlines()[number - 1].strip()


def _replaced(source: str, node: ast.expr | ast.stmt, text: str) -> str:
    """The source with the node's characters replaced; its columns count bytes."""
    lines = source.encode().splitlines(keepends=True)
    end_line, end_column = node.end_lineno or node.lineno, node.end_col_offset or 0
    before = b"".join(lines[: node.lineno - 1]) + lines[node.lineno - 1][: node.col_offset]
    after = lines[end_line - 1][end_column:] + b"".join(lines[end_line:])
    return (before + text.encode() + after).decode()


Change = tuple[str, "ast.expr | ast.stmt", "ast.expr | ast.stmt"]
"""Kind, the node to replace, what to put there."""


def _changes(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
            flipped = _COMPARISONS[type(op)]()
            yield "comparison", node, ast.Compare(left, [flipped], [right])
        case ast.BoolOp(op=op, values=values):
            other = ast.Or() if isinstance(op, ast.And) else ast.And()
            yield "and/or", node, ast.BoolOp(other, values)
            for index in range(len(values)):
                kept = values[:index] + values[index + 1 :]
                rest = kept[0] if len(kept) == 1 else ast.BoolOp(op, kept)
                yield "dropped operand", node, rest
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "dropped not", node, operand
        case ast.BinOp(left=left, op=op, right=right):
            if isinstance(right, ast.Constant) and right.value == 1:
                yield "off by one", node, left
            if type(op) in _ARITHMETIC:
                yield "operator", node, ast.BinOp(left, _ARITHMETIC[type(op)](), right)
        case ast.Constant(value=bool() as value):
            yield "constant", node, ast.Constant(not value)
        case ast.Constant(value=int() as value):
            yield "constant", node, ast.Constant(value + 1)
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield "swapped branches", node, ast.IfExp(test, orelse, body)
        case ast.If(test=test) | ast.While(test=test):
            yield "negated condition", test, ast.UnaryOp(ast.Not(), test)
        case ast.Call(func=ast.Name(id=name), args=args, keywords=keywords) if name in _FUNCTIONS:
            yield "function", node, ast.Call(ast.Name(_FUNCTIONS[name]), args, keywords)
        case ast.Expr(value=ast.Call()) | ast.AugAssign():
            yield "dropped statement", node, ast.Pass()
        case ast.Break():
            yield "dropped statement", node, ast.Pass()
        case ast.Continue():
            yield "dropped statement", node, ast.Pass()
        case _:
            return
