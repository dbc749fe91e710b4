"""The law of SEMANTICS.md by its definitions; the oracle judges by them, and imports no engine."""
