"""From text to the syntax tree: grammar, words, units, and what fixes a syntax error."""
