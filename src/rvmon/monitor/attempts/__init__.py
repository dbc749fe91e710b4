"""Open attempts: what judges them, in lanes that are driven through time."""
