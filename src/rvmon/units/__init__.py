"""Units of measure: how they are read, multiplied and compared."""
