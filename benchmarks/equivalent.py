"""Mutations that change no behaviour, with the reason; `benchmarks.mutants` draws others."""

EQUIVALENT = {
    "table.py off by one: `position - 1` => `position`": (
        "time passes up to the position before its letter is read, here or in the step itself"
    ),
    "python_class.py dropped operand: `name in uses and uses[name].history` => `name in uses`": (
        "what was before is kept of more signals, and nobody asks for it"
    ),
    "rule.py constant: `self.restless = False` => `self.restless = (True)`": (
        "a restless judge is only visited more often"
    ),
    "residual.py and/or: `left == right or not right` => `left == right and (not right)`": (
        "only a short cut to what the reduction finds"
    ),
    "residual.py swapped branches: `residual if limit is None else sorted(residual, "
    "key=_in_order)` => `sorted(residual, key=_in_order) if limit is None else residual`": (
        "the order says only which results are met on the way"
    ),
    "python_values.py dropped not: `not self.plan.uses[next(iter(names))].history` => "
    "`self.plan.uses[next(iter(names))].history`": (
        "leaves are worked out once more than needed; those with a history are marked anyway"
    ),
    "python_nodes.py off by one: `(state.high or 0) - state.low + 1` => "
    "`(state.high or 0) - state.low`": "samples are looked at that could have been passed over",
    "past.py dropped operand: `before is None or isinstance(before, str) or isinstance(now, str)` "
    "=> `before is None or isinstance(before, str)`": (
        "both are values of one signal: if one is a label, so is the other"
    ),
    "factory.py dropped statement: `flat.pop(unit, None)` => `pass`": (
        "`true and x` is only not made smaller; it still means x"
    ),
    "graph.py constant: `remembers = False` => `remembers = (True)`": (
        "what came before is replayed where going on from now would do"
    ),
    "residual.py and/or: `left == right or right == HOLDS` => `left == right and right == HOLDS`": (
        "only a short cut to what the reduction finds"
    ),
    "factory.py off by one: `self._count - 1` => `self._count`": "numbers only have to differ",
    "reduce.py negated condition: `cut < len(place.cuts[clock])` => "
    "`not cut < len(place.cuts[clock])`": "the automaton stays larger than need be",
    "past.py operator: `start - self.gap` => `start + self.gap`": (
        "stretches that touch are kept apart: more of them, for the same instants"
    ),
    "past.py constant: `self.updates = 1 if first else 2` => "
    "`self.updates = (2) if first else 2`": "after one update there is no value before it anyway",
    "construct.py off by one: `entered[clock] + 1` => `entered[clock]`": (
        "another age of the same region, or a row for one in which no step can happen"
    ),
    "ledger.py off by one: `2 * end + 1` => `2 * end`": (
        "a network has come that far before, and automata look at whole instants"
    ),
    "residual.py dropped operand: `left == right or not right` => `not right`": (
        "only a short cut to what the reduction finds"
    ),
    "python_values.py and/or: `state.leaf is not None and self._is_instant(state.leaf)` => "
    "`state.leaf is not None or self._is_instant(state.leaf)`": (
        "leaves are looked at when a value comes that would be worked out with the others anyway"
    ),
    "python_intake.py off by one: `number + 1` => `number`": (
        "only a short cut to what a sample does that brings several values"
    ),
    "python_nodes.py dropped operand: `right == '2' or left == '0'` => `left == '0'`": (
        "the greater of true and anything is written out"
    ),
    "python_nodes.py dropped operand: `state.high or 0` => `0`": (
        "samples are looked at that could have been passed over"
    ),
    "python_leaf_cases.py dropped not: `not isinstance(self.plan.graph.nodes[leaves[0]].leaf, "
    "SignalAtom)` => `isinstance(self.plan.graph.nodes[leaves[0]].leaf, SignalAtom)`": (
        "a value that brings a leaf no other truth is gone through all the same; another value of "
        "a boolean always brings one"
    ),
    "unit.py dropped operand: `triggers & 1 and rule.starts(self.v[rule.trigger])` => "
    "`rule.starts(self.v[rule.trigger])`": (
        "an episode whose trigger has not changed is only asked once more"
    ),
    "factory.py and/or: `arg in (self.state_true, self.state_false) or arg.op is StateOp.SURE` => "
    "`arg in (self.state_true, self.state_false) and arg.op is StateOp.SURE`": (
        "what is two-valued is asked once more whether it is true"
    ),
    "lower.py dropped operand: `state.op is not StateOp.SURE and any(map(_may_be_unknown, "
    "state.args))` => `state.op is not StateOp.SURE`": (
        "attempts in doubt are provided for where there are none"
    ),
    "episodes.py dropped operand: `len(places) and len(parts) < _ROUNDS` => "
    "`len(parts) < _ROUNDS`": "no attempts are judged once more",
    "episodes.py constant: `lost = len(unknown) > 0 and bool(unknown[-1] > start)` => "
    "`lost = len(unknown) > (1) and bool(unknown[-1] > start)`": (
        "each stretch has two entries: there is never one alone"
    ),
    "rule.py constant: `self.is_determined = self.is_determined or "
    "len(piece.truths[self._determined].must) > 0` => `self.is_determined = self.is_determined or "
    "len(piece.truths[self._determined].must) > (1)`": (
        "each stretch has two entries: there is never one alone"
    ),
    "outages.py dropped operand: `self._spec.signals[name].stale_after or 0` => "
    "`self._spec.signals[name].stale_after`": "the bound is only told of what has one",
    "starts.py constant: `self.looking = False` => `self.looking = (True)`": (
        "it is asked for when an attempt has begun, which sets it"
    ),
    "starts.py and/or: `not self.episodic or (not self.hidden and values[self.trigger] == TRUE and "
    "(self.unborn < 0 or values[self.unborn] != TRUE))` => `not self.episodic and (not self.hidden "
    "and values[self.trigger] == TRUE and (self.unborn < 0 or values[self.unborn] != TRUE))`": (
        "asked of an episode, one that is sure is looked at though there is nothing to see; asked "
        "of a run, its attempts are moved one by one"
    ),
    "starts.py dropped operand: `not self.episodic or (not self.hidden and values[self.trigger] == "
    "TRUE and (self.unborn < 0 or values[self.unborn] != TRUE))` => `not self.episodic`": (
        "the attempts of episodes are moved one by one, and look at triggers that are sure"
    ),
    "python_leaf_cases.py operator: `self.nodes.roles.parents[other] >> place & 1` => "
    "`self.nodes.roles.parents[other] >> place | 1`": (
        "what stands above a leaf is worked out whether or not its own operands have changed"
    ),
    "python_leaf_cases.py off by one: `self.nodes.roles.parents[other] >> place & 1` => "
    "`self.nodes.roles.parents[other] >> place`": (
        "what stands above a leaf is worked out whether or not its own operands have changed"
    ),
    "python_leaf_cases.py constant: `if not set(leaves).intersection(below[root.place]) and "
    "written[root.place][0]` => `if not set(leaves).intersection(below[root.place]) and "
    "written[root.place][(1)]`": (
        "what is settled is looked at only if an operand of its own has changed: else it is so"
    ),
    "python_leaf_cases.py and/or: `bool(kept) and (not "
    "isinstance(self.plan.graph.nodes[place].leaf, Constant))` => `bool(kept) or not "
    "isinstance(self.plan.graph.nodes[place].leaf, Constant)`": (
        "what is written for nodes that have come to their last values is used less often"
    ),
    "generated.py off by one: `self._reached - 1` => `self._reached`": (
        "a sample at the instant that time has come to takes the way of every monitor"
    ),
    "unit.py dropped operand: `self.looking and triggers & 1` => `self.looking`": (
        "a trigger that has not changed is only looked at once more"
    ),
    "schedule.py off by one: `t + 1` => `t`": (
        "where only samples are positions the next one is asked, after one that was asked in vain"
    ),
    "python_nodes.py dropped operand: `is_part and (not wanted[place]) and (depth < "
    "_DEEPEST)` => `is_part and (not wanted[place])`": (
        "an expression is longer; Python takes what the language's own limit of depth lets in"
    ),
    "python_nodes.py function: `max((depths[operand] for operand in operands[place]), "
    "default=0)` => `min((depths[operand] for operand in operands[place]), default=0)`": (
        "an expression is longer; Python takes what the language's own limit of depth lets in"
    ),
    "python_nodes.py operator: `asked >> n & 1` => `asked >> n | 1`": (
        "nodes have values of their own that nobody asks for"
    ),
    "core_form.py and/or: `isinstance(formula, Unary) and formula.op is UnaryOp.PREVIOUS` => "
    "`isinstance(formula, Unary) or formula.op is UnaryOp.PREVIOUS`": (
        "a negation that was made up is the core formula of what it denies, which tells of itself"
    ),
    "four.py dropped operand: `not isinstance(leaf, SignalAtom | Compare) or not "
    "signals_of(leaf)` => `not isinstance(leaf, SignalAtom | Compare)`": (
        "an atom that reads no signal has the same truth in all readings"
    ),
}
"""By file and change, as `Mutant.change` writes it."""
