"""Verdicts on many recordings as data: files of them, what is known to fail, what has changed."""
