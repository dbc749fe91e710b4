"""What fails of `benchmarks.timing.files.SPEC` in a CSV file, by DuckDB: `FILE`; prints instants.

Run in the peers' environment. Of the forms that were tried this is the fastest: what no
requirement looks at is left out before the window is ordered.
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
    """Print the instants at which attempts began that failed."""
    print(json.dumps(sorted(duckdb.execute(QUERY, [path]).fetchall())))


if __name__ == "__main__":
    main(*sys.argv[1:])
