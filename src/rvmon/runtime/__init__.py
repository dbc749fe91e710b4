"""What monitors in Python run on, generated or not: tables, attempts, past operators, time."""
