"""Which part of what was owed decided, or is open, and how that is worded: without attempts."""
