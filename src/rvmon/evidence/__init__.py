"""Evidence: what was judged, by what, and with which verdicts, in one archive that can be verified.

`archive` packs and unpacks it, `about` describes what it was made of, `matrix` says which
requirement is shown by what.
"""
