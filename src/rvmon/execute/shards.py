"""Shares of the work for several machines, none of which needs to know of another.

Who does one leaves a journal of its results. The same work, begun without a shard where all
journals are, finds in them what was done.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

_Task = TypeVar("_Task")


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several shares that are as large as each other."""

    number: int
    count: int

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def of(self, tasks: Sequence[_Task]) -> list[_Task]:
        """The tasks of this share; all shares together have each task once.

        >>> [Shard(number, 2).of("abcde") for number in (1, 2)]
        [['a', 'c', 'e'], ['b', 'd']]
        """
        return list(tasks[self.number - 1 :: self.count])

    def name(self, path: Path) -> Path:
        """The file of this shard in place of the file `path` of the whole.

        >>> Shard(2, 4).name(Path("out/verdicts.csv")).name
        'verdicts.shard-2-of-4.csv'
        """
        return path.with_name(f"{path.stem}.shard-{self.number}-of-{self.count}{path.suffix}")


def shards_beside(path: Path) -> list[Path]:
    """The files of all finished shards in place of a file, by name.

    Raises:
        OSError: the folder cannot be read.
    """
    pattern = f"{_literal(path.stem)}.shard-*-of-*{_literal(path.suffix)}"
    return sorted(path.parent.glob(pattern))


def _literal(name: str) -> str:
    import glob

    return glob.escape(name)
