"""Time, samples and recordings: the input of monitors, and the schema of its names."""

READINGS_OF_NAN = ("unknown", "no update")
"""The meanings of NaN: the name became unknown, or was not updated."""
