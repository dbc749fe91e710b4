"""What the oracle remembers from instant to instant changes none of its answers."""

import pytest
from tests.tools.differential import case_of

from rvmon.language.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.law.attempts import Readings, obligation
from rvmon.testing.law.decisions import follow
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.word import Rest, Truth


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
def test_memory_changes_nothing(time: TimeModel) -> None:
    """Each decision is the first instant at which a fresh evaluation gives a value."""
    compared = 0
    for seed in range(40):
        case = case_of(f"memory {seed}", Profile(time=time), TraceProfile(span=25))
        word = word_of(
            case.spec, case.samples, end=case.end, advances=case.advances, names=case.names
        )
        for requirement in case.spec.requirements.values():
            for one in follow(requirement, word).attempts:
                start = one.start
                decided = None
                for reached in range(start.triggered, word.reached + 1):
                    fresh = Readings(start.word, Rest.UNKNOWN)
                    fresh.reach(reached)
                    if obligation(start, fresh) is not Truth.UNKNOWN:
                        decided = reached
                        break
                assert decided == (None if one.decided is None else one.decided[0])
                compared += 1
    assert compared > 30
