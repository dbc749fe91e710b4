"""The arguments of each command; they import nothing that its work needs."""
