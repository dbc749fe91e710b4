"""What brings the data of running robots to live monitors, one file for each kind of source.

An adapter translates what arrives and calls `Driver.offer`; it decides nothing.
"""
