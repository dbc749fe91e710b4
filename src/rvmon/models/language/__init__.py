"""From texts to networks: parsing of `.ta`, UPPAAL's XML and Python, resolution, instantiation."""
