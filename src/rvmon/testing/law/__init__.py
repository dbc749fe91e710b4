"""The law of SEMANTICS.md by its definitions; the oracle alone judges by them."""
