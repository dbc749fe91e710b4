"""Bindings: files that say which topics and fields of recorded messages feed which names."""
