"""What generated Python monitors stand on.

These modules import nothing of rvmon, because `rvmon compile --to python` copies them into the file
it writes, in the order `past`, `table`, `rule`, `solo`, `bulk`, `nodes`, `unit`, `alone`. They are
kept to Python 3.8.
"""
