"""Tests; and tools in `tests.tools`, for benchmarks as well."""

WITHOUT = "-p no:asyncio -p no:pytest-lsp -p no:hypothesispytest -p no:anyio"
"""Plugins that a pytest within a test does without: they take a second to load."""
