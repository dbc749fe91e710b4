"""Open attempts in runs: what the builder proves; that it is so `core/test_queue.py` shows."""

import pytest

import rvmon
from rvmon.logic.automaton import moves_in_runs

HEAD = """
spec many
signal p, q : bool
event asked
"""


def proved(body: str) -> bool:
    spec = rvmon.loads(f"{HEAD}requirement R1\n  {body}\n")
    [requirement] = spec._compiled.requirements.values()
    assert requirement.automaton is not None
    return moves_in_runs(requirement.automaton)


@pytest.mark.parametrize(
    "body",
    [
        "upon asked\n  then within 1 h p",
        "upon asked\n  then for 2 s not p",
        "upon asked\n  then p until[1 s, 3 s] q",
        "upon asked\n  then eventually[2 s, 5 s] p",
    ],
)
def test_one_clock_from_the_trigger_is_proved(body):
    """What most requirements are moves in runs."""
    assert proved(body)


@pytest.mark.parametrize(
    "body", ["whenever p\n  then within 2 s q", "upon asked\n  then within 2 s (p and for 1 s q)"]
)
def test_a_clock_that_is_started_later_is_none(body):
    """A run could lose its order: only attempts that share their clocks are stepped together."""
    assert not proved(body)
