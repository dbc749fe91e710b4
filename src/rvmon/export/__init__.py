"""What is made of our data for other tools: automata networks as XML and drawings."""
