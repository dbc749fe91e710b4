"""Tools to test monitors with: the reference oracle, random specs and traces, comparison."""
