"""For testing monitors: the reference oracle, random specifications and traces."""
