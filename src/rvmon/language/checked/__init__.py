"""Specifications whose names, types and units are settled: data, and what is read off them."""
