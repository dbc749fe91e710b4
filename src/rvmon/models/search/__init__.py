"""The model checker: search, queries, witnesses, and test suites that cover a network."""
