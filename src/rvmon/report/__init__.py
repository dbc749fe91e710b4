"""Tables as data, and renderers of reports for terminal, files and pages."""
