"""Requirements judged on columns by arrays: Python works per piece of a trace, not per row."""
