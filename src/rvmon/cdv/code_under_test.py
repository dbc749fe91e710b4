"""The code under test whose coverage is measured: named blocks of named files."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rvmon.errors import RvmonError, UnknownNameError

COMMON = "common"
"""The block of what has no other."""


@dataclass(frozen=True, slots=True)
class Block:
    """Lines of a file that belong together, such as those of a state of the robot.

    Attributes:
        name: unique in a campaign.
        path: of the source file.
        lines: from 1 on; those without a statement count for nothing.
    """

    name: str
    path: str
    lines: frozenset[int]


@dataclass(frozen=True, slots=True)
class Code:
    """The code whose coverage is measured.

    Attributes:
        blocks: in the order in which they are shown.
        branches: whether branches are measured as well as statements.
        marked: only what runs within `observer.code()` is measured, so that a simulation around the
            code under test is not slowed down; else all of `play` is.
        kind: the word for a block, in the singular.
        constants: by path of a file, names at its top whose values are the code's numbers: they are
            mutated as its functions are, and not measured.
        equivalent: a TOML file of mutants that change no behaviour, each with the argument.
    """

    blocks: Sequence[Block]
    branches: bool = True
    marked: bool = False
    kind: str = "block"
    constants: Mapping[str, Sequence[str]] = field(default_factory=dict)
    equivalent: str | Path | None = None

    def __post_init__(self) -> None:
        """See that each block can be told from the others.

        Raises:
            RvmonError: two have one name, as functions of two files may.
        """
        named = {block.name: block for block in self.blocks}
        for block in self.blocks:
            if named[block.name] is not block:
                raise RvmonError(
                    f"two blocks are called `{block.name}`, in {block.path} and in "
                    f"{named[block.name].path}: name one otherwise"
                )


def blocks_of(path: str | Path, names: Mapping[str, str] | None = None) -> tuple[Block, ...]:
    """The functions of a file as blocks, without the lines that define them.

    Args:
        path: of a Python file, which is read and not run.
        names: the block of each function, as `{"Base.brake": "braking"}`; functions of one block
            count together, those that are left out are `common`. Default: each for itself.

    Raises:
        UnknownNameError: the file has no such function.
        RvmonError: it cannot be read, or is no Python.
    """
    try:
        tree = ast.parse(Path(path).read_bytes(), filename=str(path))
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}") from None
    except (SyntaxError, ValueError) as error:
        raise RvmonError(f"{path}: not Python: {error}") from None
    functions = dict(_functions(tree, ""))
    for name in names or ():
        if name not in functions:
            raise UnknownNameError(
                f"{path}: no function `{name}`: there are {', '.join(functions)}"
            )
    blocks: dict[str, set[int]] = {name: set() for name in (names or {}).values()}
    for name, lines in functions.items():
        blocks.setdefault(name if names is None else names.get(name, COMMON), set()).update(lines)
    # What Python loads has this very path: that of a link is another.
    file = str(Path(path).absolute())
    return tuple(Block(name, file, frozenset(lines)) for name, lines in blocks.items())


def _functions(tree: ast.AST, prefix: str) -> Iterator[tuple[str, range]]:
    """Functions and methods by their qualified names; what stands in a function is part of it."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.end_lineno is not None, "parsed from a text"
            yield f"{prefix}{node.name}", range(node.lineno + 1, node.end_lineno + 1)
        elif isinstance(node, ast.ClassDef):
            yield from _functions(node, f"{prefix}{node.name}.")
        elif not isinstance(node, ast.expr):
            yield from _functions(node, prefix)
