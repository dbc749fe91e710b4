"""Specification text to checked specification: grammar, syntax tree, names, types, units."""
