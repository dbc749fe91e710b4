"""What the oracle remembers from instant to instant changes none of its answers."""

from __future__ import annotations

import pytest

from rvmon.spec.checked import TimeModel
from rvmon.testing.attempts import obligation, starts
from rvmon.testing.differential import case_of
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile
from rvmon.testing.kleene import Truth
from rvmon.testing.oracle import follow
from rvmon.testing.truths import Truths
from rvmon.testing.wording import word_of


@pytest.mark.parametrize("time", TimeModel)
def test_memory_changes_nothing(time: TimeModel) -> None:
    """Each decision is the first instant at which a fresh evaluation gives a value."""
    compared = 0
    for seed in range(40):
        case = case_of(f"memory {seed}", Profile(time=time), TraceProfile(span=25))
        word = word_of(
            case.spec, case.samples, end=case.end, advances=case.advances, names=case.names
        )
        for name, followed in follow(case.spec, word, case.samples).items():
            requirement = case.spec.requirements[name]
            assert [one.start.position for one in followed] == [
                start.position for start in starts(requirement, word)
            ]
            for one in followed:
                start = one.start
                first = word.letters[start.position].instant
                decided = None
                for reached in range(first, word.reached + 1):
                    fresh = Truths(start.word, start.captured)
                    fresh.reach(reached)
                    if obligation(requirement, start, fresh) is not Truth.UNKNOWN:
                        decided = reached
                        break
                assert decided == (None if one.decided is None else one.decided[0])
                compared += 1
    assert compared > 30
