"""Requirements of a specification, checked on all runs of a network."""
