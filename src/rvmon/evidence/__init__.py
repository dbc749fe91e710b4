"""Evidence: what was judged, by what, with which verdicts, in one archive that can be verified."""
