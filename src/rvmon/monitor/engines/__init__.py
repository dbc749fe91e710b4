"""The engines: one file for each, `registry` for all of them, `refusal` for what they cannot do."""
