"""A mutant of a source file: data."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

THIRDS = ("A", "B", "held out")
"""Mutants are shared among these by their identities; who improves a suite looks at the first two.

A score on mutants that were looked at says how well they were looked at.
"""

HELD_OUT = THIRDS[-1]


def third_of(identity: str) -> str:
    """The third that an identity is in.

    >>> third_of("R1:bound:1") in THIRDS
    True
    """
    return THIRDS[int.from_bytes(hashlib.sha256(identity.encode()).digest()) % len(THIRDS)]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one file.

    Attributes:
        path: the file.
        line: where, from 1.
        kind: of change: the name of an operator.
        before: the changed code as it was.
        after: as it is.
        source: the whole file as it is.
        function: the qualified name of the function, or the name of the constant, that is changed.
        ordinal: which it is of the changes of this kind to this function, from 1.
    """

    path: Path
    line: int
    kind: str
    before: str
    after: str
    source: str
    function: str = ""
    ordinal: int = 0

    @property
    def change(self) -> str:
        """File and change, without the line: what it is known by when the file grows."""
        return f"{self.path.name} {self.kind}: `{self.before}` => `{self.after}`"

    @property
    def brief(self) -> str:
        """The change, of several lines the first."""
        return f"{_first(self.before)} => {_first(self.after)}"

    @property
    def identity(self) -> str:
        """What it is known by in lists: file, function, kind and ordinal."""
        return f"{self.path.stem}:{self.function}:{self.kind}:{self.ordinal}".replace(" ", "-")

    @property
    def third(self) -> str:
        """The third that it is in, which follows from its identity: nobody can choose."""
        return third_of(self.identity)

    def __str__(self) -> str:
        return f"line {self.line:>3} of {self.change}"


def _first(code: str) -> str:
    first, *others = code.splitlines()
    return f"{first} …" if others else first
