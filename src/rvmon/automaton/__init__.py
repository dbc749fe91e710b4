"""Deterministic timed monitors as data, their construction, and how they are driven."""
