"""Random coverpoints and crosses against their definition; `benchmarks` does the same for hours."""

import json
import random

import pytest
from tests.tools.random_specs import with_random_coverage

from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace


@pytest.mark.law
def test_rows_hit_what_their_samples_hit(tmp_path):
    for seed in range(15):
        rng = random.Random(seed)
        profile = Profile(requirements=1, captures=False, for_each=False)
        spec = Spec(with_random_coverage(rng, profile))
        coverage = spec.coverage_model
        for place in range(3):
            case = random_trace(rng, spec.checked, TraceProfile(long=10, advances=False))
            if not case.samples:
                continue
            path = tmp_path / f"{place}.jsonl"
            path.write_text("".join(map(_line, case.samples)), encoding="utf-8")
            monitor = coverage.monitor()
            for sample in spec.recording(path):
                monitor.step_ns(sample.t, sample.values)
            expected = monitor.finish_ns(case.end)
            assert coverage.of(spec.recording(path), case.end) == expected
            until = case.samples[len(case.samples) // 2].t
            monitor.reset()
            for sample in spec.recording(path):
                if sample.t <= until:
                    monitor.step_ns(sample.t, sample.values)
            assert coverage.of(spec.recording(path), until) == monitor.finish_ns(until)


def _line(sample):
    values = {name: None if value != value else value for name, value in sample.values.items()}
    return json.dumps({"t_ns": sample.t, **values}) + "\n"
