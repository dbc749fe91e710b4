"""For testing monitors: the reference oracle, Hypothesis strategies, the agreement of engines."""
