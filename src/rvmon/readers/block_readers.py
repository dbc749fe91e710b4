"""What reads a file by columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rvmon.readers.blocks import Block
    from rvmon.trace.schema import Schema

    Reader = Callable[[str | Path, Schema, frozenset[str]], Iterator[Block]]


def reader_of(path: str | Path, ignored: Counter[str]) -> Reader | None:
    """What reads blocks of a file, by the ending of its name.

    Args:
        path: of the file.
        ignored: counts undeclared names, where each line has its own.
    """
    match Path(path).suffix.lower():
        case ".csv":
            from rvmon.readers.csv_blocks import csv_blocks

            return csv_blocks
        case ".parquet":
            from rvmon.readers.parquet import parquet_blocks

            return parquet_blocks
        case ".jsonl" | ".ndjson":
            from rvmon.readers.jsonl_blocks import jsonl_blocks

            return partial(jsonl_blocks, ignored=ignored)
    return None
