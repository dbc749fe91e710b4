"""From text to the syntax tree: grammar, words, units, and what mends a syntax error."""
