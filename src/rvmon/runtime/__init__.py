"""What monitors in Python run on, generated or not: tables, attempts, past operators, time.

These modules import nothing of rvmon but each other, because `rvmon compile --to python` copies
them into the file it writes, in the order `past`, `table`, `rule`, `solo`, `bulk`, `nodes`, `unit`,
`standalone`. They are kept to Python 3.8.
"""
