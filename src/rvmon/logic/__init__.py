"""From a checked requirement to its formula, its automaton or network, and the plan to run it.

Pure data and algorithms: no samples, no C, no texts for people. A requirement is lowered (`lower`,
`normal_form`, `three_valued`) to a core formula (`formula`). Progression (`progress`) unfolds the
formula into an automaton (`construct`, `reduce`). If the automaton exceeds its budget, the formula
becomes a network of windows instead (`network_plan`). `plan` combines several requirements.
"""
