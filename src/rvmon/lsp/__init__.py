"""A language server for specifications: what editors ask about a text that is being written."""
