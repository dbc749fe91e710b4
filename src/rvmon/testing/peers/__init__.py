"""Other monitors, asked for their verdicts: what formulas are in their words, and how to ask."""
