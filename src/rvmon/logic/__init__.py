"""From a checked requirement to its formula, its automaton or network, and the plan to run it.

Pure data and algorithms: no samples, no C, and no words for people. A requirement is lowered
(`lower`, `normal_form`, `three_valued`) to a core formula (`formula`), which progression
(`progress`) unfolds into an automaton (`construct`, `reduce`) or, where that does not close, leaves
as a network of windows (`network_plan`). `plan` puts several requirements together.
"""
