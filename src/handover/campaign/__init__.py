"""The campaign of simulated handovers: its strategies, gates, tables and pages."""
