"""Queues of open attempts: which automata allow them. `core/test_queue.py` tests their use."""

from tests.tools.each import each

import rvmon
from rvmon.logic.automaton import moves_in_runs


@each(
    ("required", "is_proved"),
    [
        # Most requirements have one clock, started at the trigger: whole queues move at once.
        ("upon e then within 1 h p", True),
        ("upon e then for 2 s not p", True),
        ("upon e then p until[1 s, 3 s] q", True),
        ("upon e then eventually[2 s, 5 s] p", True),
        # The order could change: only attempts with equal clocks are stepped together.
        ("whenever p then within 2 s q", False),
        ("upon e then within 2 s (p and for 1 s q)", False),
    ],
)
def test_one_clock_from_the_trigger_is_proved(required, is_proved):
    spec = rvmon.loads(f"signal p, q : bool\nevent e\nrequirement R1\n  {required}\n")
    [requirement] = spec._compiled.requirements.values()
    assert requirement.automaton is not None
    assert moves_in_runs(requirement.automaton) is is_proved
