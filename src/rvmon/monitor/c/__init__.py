"""Compiled C as a monitor: of streams, of columns, of one recording alone."""
