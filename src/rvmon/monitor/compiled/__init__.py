"""Requirements made ready for the core, and the plan of them."""
