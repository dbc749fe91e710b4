"""The handover as a network of six timed automata, and what is asked of it."""
