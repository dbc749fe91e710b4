"""Time, samples and recordings: what monitors read, and the schema of its names."""

READINGS_OF_NAN = ("unknown", "no update")
"""The two meanings of NaN: the name became unknown, or it was not updated."""
