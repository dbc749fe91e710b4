"""Adapters from middleware to live monitors, one file for each kind of source.

An adapter translates messages to samples and calls `Driver.offer`; it judges nothing.
"""
