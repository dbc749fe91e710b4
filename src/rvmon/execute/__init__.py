"""Processes that are begun here, and never outlive the one that began them.

`parallel.execute` shares tasks among processes; nothing else starts any for Python's work.
`command.run` runs a program, `interrupt.interrupted_by_sigterm` has both cleaned up.
"""
