"""Records of decisions do not depend on calls that only advance time."""

import random
from dataclasses import replace
from itertools import accumulate

import pytest
from tests.tools.build import requirement, spec_of
from tests.tools.random_specs import random_mtl

from rvmon.language.checked.formula import EventAtom
from rvmon.language.checked.specification import TimeModel
from rvmon.session import Spec


@pytest.mark.law
@pytest.mark.parametrize("time", [TimeModel.HELD, TimeModel.CLOCKED])
def test_advancing_changes_no_record(time):
    decided = 0
    for seed in range(60):
        rng = random.Random(f"advance/{seed}")
        formula = random_mtl(rng, rng.randint(1, 3))
        upon = requirement(formula, upon=EventAtom("e"))
        spec = Spec(spec_of(upon, time=time, period=1 if time is TimeModel.CLOCKED else None))
        stamps = list(accumulate(rng.randint(1, 6) for _ in range(8)))
        samples = [
            (t, {**{name: rng.random() < 0.5 for name in "pqr"}, "e": rng.random() < 0.5})
            for t in stamps
        ]
        found = []
        for split in (False, True):
            monitor = spec.monitor()
            for t, values in samples:
                monitor.step_ns(t, values)
                if split:
                    for later in sorted({t + rng.randint(1, 5), t + rng.randint(1, 5)}):
                        if all(later < other or t >= other for other in stamps):
                            monitor.advance_ns(later)
            attempts = monitor.finish_ns(stamps[-1] + 9).attempts
            # Values at an instant are unknown while time has only advanced to it.
            found.append([repr(replace(attempt, at_decision={})) for attempt in attempts])
        assert found[0] == found[1], formula
        decided += len(found[0])
    assert decided > 60
