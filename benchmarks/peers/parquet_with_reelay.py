"""A Parquet file judged by reelay's Python package: `FILE PATTERN`; prints the first violated row.

Run in the peers' environment.
"""

import sys

import pyarrow.parquet
import reelay


def main(path: str, pattern: str) -> None:
    """Judge the columns other than the time, row by row."""
    update = reelay.discrete_timed_monitor(pattern=pattern, condense=False).update
    violated, row = -1, 0
    file = pyarrow.parquet.ParquetFile(path)
    names = [name for name in file.schema_arrow.names if name != "t_ns"]
    for batch in file.iter_batches(1 << 16, columns=names):
        for values in batch.rename_columns([f"v_{name}" for name in names]).to_pylist():
            if not update(values)["value"] and violated < 0:
                violated = row
            row += 1
    print(0, violated)


if __name__ == "__main__":
    main(*sys.argv[1:])
