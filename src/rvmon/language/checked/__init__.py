"""Checked specifications as data, with the analyses that many packages share."""
