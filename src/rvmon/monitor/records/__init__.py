"""The records of attempts: numbers, order, and what is told of each."""
