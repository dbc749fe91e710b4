"""State formulas over the input, evaluated as it changes."""
