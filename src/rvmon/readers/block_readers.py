"""What reads a file by columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.readers.blocks import NotPlainError

if TYPE_CHECKING:
    from rvmon.readers.blocks import Block
    from rvmon.trace.schema import Schema

    Reader = Callable[[str | Path, Schema, frozenset[str]], Iterator[Block]]


def reader_of(path: str | Path, schema: Schema, ignored: Counter[str]) -> Reader:
    """What reads blocks of a file, by the ending of its name.

    Args:
        path: of the file.
        schema: says whether values stand for no update: these are looked for in rows.
        ignored: counts undeclared names, where each line has its own.

    Raises:
        NotPlainError: each row has to be read.
    """
    if schema.gaps:
        raise NotPlainError("values that stand for no update are looked for in rows")
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
        case _:
            raise NotPlainError("it is a stream")
