"""What can be wrong with a specification: each rule with its documentation, by family."""
