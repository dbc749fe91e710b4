"""Networks of timed automata with all names resolved: data, and what their expressions mean."""
