"""The model checker: search, queries, witnesses, and suites that cover a network."""
