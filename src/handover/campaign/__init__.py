"""Campaigns: many tests on all cores, their table, their files and pages."""
