"""What tests and benchmarks share: cases by hand, the law on them, differential tests, oracles."""
