"""Random formulas, specifications and traces, biased towards what monitors get wrong."""
