"""Adapters that connect middleware to live monitors, one file per kind of source.

An adapter translates messages to samples and calls `Driver.offer`; it judges nothing.
"""
