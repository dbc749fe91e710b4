"""From where specifications may be imported."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

_MARKS = (".git", "pyproject.toml")
"""What stands in the root of a project."""


@dataclass(frozen=True, slots=True)
class Tree:
    """The folders that imports may lead into.

    Attributes:
        root: of the project.
        others: that a person has allowed.
    """

    root: Path
    others: tuple[Path, ...] = ()

    def holds(self, file: Path) -> bool:
        """Whether a file lies within, where links lead.

        Raises:
            ValueError: a null character is in the name.
            OSError: links lead round in a circle.
        """
        real = file.resolve()
        return any(real.is_relative_to(folder) for folder in (self.root, *self.others))


def tree_of(directory: Path) -> Tree:
    """The tree of a main file in a folder: that of its project, else the folder itself."""
    own = directory.resolve()
    marked = (
        folder for folder in (own, *own.parents) if any((folder / mark).exists() for mark in _MARKS)
    )
    named = os.environ.get("RVMON_ALLOW_IMPORTS", "").split(os.pathsep)
    return Tree(next(marked, own), tuple(Path(name).resolve() for name in named if name))
