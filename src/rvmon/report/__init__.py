"""What people look at: tables as data, and renderers for terminal, files and pages."""
