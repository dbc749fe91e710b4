"""How requirements run: state formulas as one graph, and what judges."""
