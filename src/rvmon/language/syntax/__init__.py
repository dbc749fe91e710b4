"""From text to the syntax tree: grammar, keywords, and fixes for syntax errors."""
