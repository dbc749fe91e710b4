"""The symbolic semantics: zones, discrete states, and the steps between them."""
