"""Online monitors: a specification judged sample by sample."""
