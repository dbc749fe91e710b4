"""Requirements made ready for engines, the plan of their code, and what engines refuse."""
