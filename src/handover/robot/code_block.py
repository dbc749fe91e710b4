"""A function of the robot's code, and the state that it belongs to."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CodeBlock:
    """One function of the robot's code.

    Attributes:
        state: the state that it belongs to, or `layout.COMMON`.
        function: its name.
        path: of the source file.
        first: its first line, that of `def`.
        last: its last line.
    """

    state: str
    function: str
    path: str
    first: int
    last: int
