"""Which part of what was owed decided, or is open, and how that is said: without attempts."""
