"""Open attempts: what judges them, in evaluators that are driven through time."""
