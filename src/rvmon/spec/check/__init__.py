"""From names to the checked specification: types, units, durations, requirements."""
