"""What comes in: whether it can be taken, in which order, and what of it was not known."""
