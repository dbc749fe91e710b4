"""Tests; and tools in `tests.tools`, for benchmarks as well."""
