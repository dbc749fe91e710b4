"""Open attempts in runs: what the builder proves, and that it is so."""

import pytest
from tests.tools.compare import differences
from tests.tools.drive import drive
from tests.tools.forms import Maker
from tests.tools.law import judge

import rvmon
from rvmon.logic.automaton import moves_in_runs
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample

HEAD = """
spec many
signal p, q : bool
event asked
"""


def compiled(body: str, time: str = "held"):
    text = f"{HEAD}requirement R1\n  {body}\n".replace("spec many", f"spec many\ntime {time}")
    return rvmon.loads(text)


def proved(body: str) -> bool:
    [requirement] = compiled(body)._compiled.requirements.values()
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


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 3 ns"])
@pytest.mark.parametrize(
    "body",
    [
        "upon asked\n  then within 40 ns p",
        "upon asked\n  then eventually[7 ns, 40 ns] p",
        "upon asked\n  then p until[2 ns, 30 ns] q",
        "upon asked\n  then for 25 ns not p",
    ],
)
def test_many_attempts_are_judged_as_one_by_one(time, body):
    spec = compiled(body, time)
    assert moves_in_runs(spec._compiled.requirements["R1"].automaton)
    actions = []
    for t in range(150):
        values = {"asked": True} if t % 2 else {}
        if t % 60 == 20:
            values |= {"p": None if t == 140 else True, "q": t % 120 == 20}
        if t % 60 == 23:
            values |= {"p": "until" in body, "q": False}
        actions.append(Sample(t + t // 9, values))
        if t % 50 == 7:
            actions.append(t + t // 9 + 1)
    case = Case(spec.checked, tuple(actions), 220)
    report, returned = drive(Maker()(case), case)
    assert differences(judge(case), report) == []
    told = [one for decided in returned for one in decided]
    assert len(told) > 30
    assert len({attempt.verdict for attempt in told}) > ("until" not in body)
