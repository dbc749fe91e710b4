"""What a specification can and cannot do, found out before any run."""
