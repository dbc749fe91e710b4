"""The records of attempts: numbers, order, and what is reported of each."""
