"""Tables of Markdown, which terminals and documents show alike."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

BAR = "\\|"
"""As a cell of a table has it."""


def table(head: Sequence[str], rows: Iterable[Iterable[object]]) -> Iterator[str]:
    """The lines of a table, each as its row comes.

    >>> [*table(["a", "b"], [[1, 2.5]])]
    ['| a | b |', '|---|---|', '| 1 | 2.5 |']
    """
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for row in rows:
        yield f"| {' | '.join(str(cell).replace('|', BAR) for cell in row)} |"


def show(head: Sequence[str], rows: Iterable[Iterable[object]]) -> None:
    """Print a table, row by row."""
    for line in table(head, rows):
        print(line, flush=True)
