"""How far attempts are from the other verdict, followed beside the verdicts."""
