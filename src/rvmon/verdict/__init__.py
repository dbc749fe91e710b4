"""Verdicts, the records of attempts, reports; the fold and the rule for the end of a trace."""
