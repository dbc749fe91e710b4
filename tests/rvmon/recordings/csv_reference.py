"""CSV read row by row with Python's `csv`: the reference for reading it in blocks."""

from collections.abc import Iterator
from pathlib import Path

import rvmon
from rvmon.recordings.csv_rows import csv_samples, read_layout, split_lines
from rvmon.recordings.rows import Rows
from rvmon.trace.sample import Sample


def samples_of_csv(spec: rvmon.Spec, path: Path) -> Iterator[Sample]:
    """The samples of a file; errors are named as those of a recording are."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as text:
            rows = split_lines(text)
            layout = read_layout(next(rows)[1], spec.schema)
            made = Rows(spec.schema, "line", ordered=True)
            yield from made.samples(csv_samples(rows, layout))
            if not made.count:
                raise rvmon.TraceError("holds no sample")
    except rvmon.TraceError as error:
        raise type(error)(f"{path}: {error}") from None
