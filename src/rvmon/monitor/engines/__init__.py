"""The engines: one file for each, `registry` for all of them, `choice` for what `auto` takes."""
