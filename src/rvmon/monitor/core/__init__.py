"""What the core judges: of streams, of columns; and its records as reports."""
