"""From texts to networks: `.ta`, UPPAAL's XML and Python, parsed, resolved, instantiated."""
