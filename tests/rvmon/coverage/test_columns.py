"""Coverage of columns, counted over many rows at once, equals that of their samples."""

import json
import random

import numpy as np
import pytest
from tests.tools.random_specs import with_random_coverage

from rvmon import loads
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace

DECLARED = """signal x, y : real
signal old : real stale after 40 ms
signal heard : real ignore NaN
signal b : bool
signal n : int
event e
"""
COMPARISONS = ("<", "<=", "==", "!=", ">=", ">")
FURTHER = ("x < y", "n > 1", "held(b, 30 ms)", "changed(b)", "old < 2", "heard >= 2", "e")
HELD, MILLISECOND = 0.7, 1_000_000


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 10 ms"])
@pytest.mark.parametrize("rows", [5, 64, 65, 200])
def test_columns_hit_what_their_samples_hit(time, rows):
    for seed in range(12):
        rng = random.Random(f"{time} {rows} {seed}")
        spec = loads(f"time {time}\n{DECLARED}{random_points(rng, seed % 3 == 0)}")
        table = random_table(rng, rows)
        monitor = spec.coverage_model.monitor(requirements=False)
        for t, values in samples_of(table):
            monitor.step_ns(t, values)
        hits = spec.coverage_model.of(spec.recording(table), requirements=False)
        assert hits == monitor.finish_ns()
        assert sum(hit.count for items in hits.values() for hit in items.values()) > 0


def random_points(rng, with_further):
    """Random coverpoints of comparisons; `with_further`: of all kinds, some sampled at events."""

    def condition():
        if with_further and rng.random() < 0.3:
            return rng.choice(FURTHER)
        one = f"{rng.choice('xy')} {rng.choice(COMPARISONS)} {rng.randrange(5)}"
        return rng.choice([one, "b", f"not ({one} and b)", f"{one} or y > 3"])

    def occasion():
        return "\n  upon e" if with_further and rng.random() < 0.3 else ""

    lines = []
    for number in range(rng.randrange(2, 5)):
        bins = ", ".join(f"b{place}: {condition()}" for place in range(rng.randrange(1, 4)))
        lines.append(f"coverpoint c{number} {{{bins}}}{occasion()}")
    lines.append("coverpoint ranges = x {low: [0, 1.5), mid: [1, 3), high: [3, 6)}")
    lines.append(f"cross both = ranges, c0, c1{occasion()}")
    return "\n".join(lines) + "\n"


def random_table(rng, rows):
    """Random columns; some change at every row, some cells are NaN, some rows share an instant."""
    repeats, nans = rng.random() < 0.3, rng.random() < 0.4
    steps = [rng.choice([10, 10, 100]) for _ in range(rows)]
    if repeats:
        steps = [0 if rng.random() < 0.05 else step for step in steps]
    stays = rng.choice([0.0, HELD])

    def reals():
        value, column = 0.0, []
        for _ in range(rows):
            value = value if rng.random() < stays else rng.randrange(11) / 2
            column.append(float("nan") if nans and rng.random() < 0.03 else value)
        return np.array(column)

    rare = rng.choice([0.01, 0.1])
    return {
        "t_ns": np.cumsum(steps) * MILLISECOND,
        **{name: reals() for name in ("x", "y", "old", "heard")},
        "b": np.array([rng.random() < 0.5 for _ in range(rows)]),
        "n": np.array([row // 20 % 4 for row in range(rows)]),
        "e": np.array([rng.random() < rare for _ in range(rows)]),
    }


def samples_of(table):
    """The rows of one instant as one sample, with the last values and the events."""
    samples = {}
    for row, t in enumerate(table["t_ns"].tolist()):
        values = samples.setdefault(t, {})
        for name, column in table.items():
            value = column[row].item()
            if name == "e":
                values |= {"e": True} if value else {}
            elif name != "t_ns" and not (name == "heard" and value != value):
                values[name] = None if value != value else value
    return samples.items()


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
