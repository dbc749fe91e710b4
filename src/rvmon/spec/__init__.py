"""Specification text to checked specification: grammar, syntax tree, names, types, units."""

from rvmon.spec.compile import compile_text

__all__ = ["compile_text"]
