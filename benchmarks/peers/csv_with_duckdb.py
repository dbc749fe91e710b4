"""Find the failures of `benchmarks.timing.files.SPEC` in a CSV file with DuckDB; print instants.

Takes the file as argument, and runs in the peers' environment. Of the queries that were tried this
is the fastest: rows that no requirement needs are removed before the window is sorted.
"""

import json
import sys

import duckdb

QUERY = """
with looked_at as (
    select * from read_csv(?, header = true, columns = {
        't_ns': 'BIGINT', 'speed': 'DOUBLE', 'obstacle': 'DOUBLE', 'stop': 'BOOLEAN'})
    where stop or speed <= 0.05 or obstacle < 0.5
), answered as (
    select *, min(case when speed <= 0.05 then t_ns end) over (
        order by t_ns rows between current row and unbounded following) as slow
    from looked_at
)
select 'B1', t_ns from answered where obstacle < 0.5 and speed > 0.3
union all
select 'B2', t_ns from answered where stop and (slow is null or slow > t_ns + 500000000)
"""


def main(path: str) -> None:
    """Print the trigger instants of failed attempts."""
    print(json.dumps(sorted(duckdb.execute(QUERY, [path]).fetchall())))


if __name__ == "__main__":
    main(*sys.argv[1:])
