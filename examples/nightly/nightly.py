"""Judge a folder of logs on all cores, write the verdicts to Parquet, and query them with DuckDB.

python examples/nightly/nightly.py LOGS verdicts.parquet
"""

import os
import sys
from pathlib import Path

import duckdb

import rvmon
from rvmon.verdicts.table_file import write_results

WORST = """
    SELECT requirement, recording,
           count(*) FILTER (WHERE verdict = 'F') AS failures,
           count(*) AS attempts,
           max(decided_s - triggered_s) AS longest_s
    FROM read_parquet($1)
    WHERE attempt IS NOT NULL
    GROUP BY ALL HAVING failures > 0
    ORDER BY failures DESC, recording, requirement
"""


def main(logs: str, out: str) -> None:
    """Judge the logs, write the verdicts, and print which requirements fail in which log."""
    spec = rvmon.load(Path(__file__).parents[1] / "base.rv")
    paths = sorted(map(str, Path(logs).glob("**/*.csv")))
    reports = spec.evaluate_many(paths, jobs=os.cpu_count() or 1)
    rows = (row for report in reports for row in report.rows())
    write_results(out, rows, {"spec": spec.checked.name})
    for requirement, recording, failures, attempts, longest in duckdb.execute(
        WORST, [out]
    ).fetchall():
        name = Path(recording).relative_to(logs)
        print(f"{requirement} fails {failures} of {attempts} times in {name}, up to {longest:g} s")


if __name__ == "__main__":
    main(*sys.argv[1:])
