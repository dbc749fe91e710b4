"""Work for many tasks: processes that never outlive who began them, results that outlive all.

`parallel.execute` shares tasks among processes, or the workers of a scheduler of Dask; nothing else
starts any for Python's work. `shard` is a share of the work that knows of no other.
`journal` keeps results as they come, so that work which was ended goes on.
`command.run` runs a program, `ended.interrupted_by_sigterm` has both cleaned up.
"""
