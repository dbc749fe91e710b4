"""`keep` limits the records of each verdict to the newest, and changes nothing else."""

import random
from collections import Counter
from dataclasses import fields

import pytest
from tests.tools.drive import feed

from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.monitor import build_monitor
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report


def told(attempt):
    return tuple(str(getattr(attempt, one.name)) for one in fields(Attempt))


@pytest.mark.slow
@pytest.mark.parametrize("time", TimeModel)
def test_the_newest_records_are_kept_and_the_others_are_counted(time):
    dropped = 0
    for seed in range(4):
        rng = random.Random(f"keep/{time.name}/{seed}")
        spec = random_spec(rng, Profile(time=time, requirements=3))
        case = random_trace(rng, spec, TraceProfile(samples=300, fewest=200, span=900))
        compiled, keep = CompiledSpec(spec), rng.randint(0, 4)
        whole = build_monitor(compiled, sources=case.names)
        kept = build_monitor(compiled, sources=case.names, keep=keep)
        for action in case.actions:
            want, got = feed(whole, action), feed(kept, action)
            assert list(map(told, got)) == list(map(told, want))
            assert kept.next_due == whole.next_due
        everything = {told(one) for one in whole.open}
        assert {told(one) for one in kept.open} <= everything
        want, got = whole.finish_ns(case.end), kept.finish_ns(case.end)
        assert (got.verdicts, got.counts) == (want.verdicts, want.counts)
        expected = Counter()
        for one in want.attempts:
            expected[one.requirement, one.verdict] += 1
        there = Counter((one.requirement, one.verdict) for one in got.attempts)
        assert there == +Counter({kind: min(keep, count) for kind, count in expected.items()})
        assert {told(one) for one in got.attempts} <= {told(one) for one in want.attempts}
        for name in spec.requirements:
            for verdict in "PF":
                own = [one for one in want.of(name, verdict) if one.decided is not None]
                left = [one for one in got.of(name, verdict) if one.decided is not None]
                assert list(map(told, left)) == list(map(told, own))[len(own) - len(left) :]
        for (name, verdict), count in expected.items():
            left_out = got.dropped.get(name, {}).get(verdict, 0)
            assert left_out == max(0, count - keep)
            dropped += left_out
        assert Report.from_json(got.to_json()) == got
    assert dropped > 150
