"""A first specification from a recording: what is in it, and requirements that run at once."""
