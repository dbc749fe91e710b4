"""Recordings are measured equally as arrays and sample by sample."""

import random

import numpy as np
import pytest
from tests.tools.differential import case_of
from tests.tools.doors import content_of, whole
from tests.tools.random_specs import with_few_news

import rvmon
from rvmon.language.checked.specification import TimeModel
from rvmon.recordings.source import Source
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.trace.sample import Trace


def arrays_of(times, columns):
    return {name: np.array(column) for name, column in {"t_ns": times, **columns}.items()}


def figures_of(margins):
    streams = {name: list(stream) for name, stream in margins.streams.items()}
    return dict(margins.attempts), dict(margins.doubtful), streams


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
@pytest.mark.parametrize("unknowns", [False, True])
def test_columns_and_rows_have_the_same_verdicts_and_robustness(time, unknowns):
    """Also if most rows change no verdict; evenly spaced rows take another path."""
    traces = TraceProfile(samples=300, fewest=70, span=900, unknowns=unknowns)
    measured = 0
    for number in range(8):
        rng = random.Random(f"long {time} {number}")
        case = case_of(f"long {time} {number}", Profile(time=time), traces)
        content = whole(content_of(rng, with_few_news(rng, case)))
        times = [t for t, _ in content.rows] if number % 2 else [*range(len(content.rows))]
        arrays = arrays_of(times, {n: [c[n] for _, c in content.rows] for n in content.columns})
        spec = Spec(case.spec)
        read = spec.recording(arrays, allow_missing=True)
        rows = Trace((*read,), read.names, read.end)
        found = spec.robustness(arrays, allow_missing=True)
        assert figures_of(found) == figures_of(spec.robustness(rows)), number
        found, expected = (spec.judge(Source(one), robustness=True) for one in (read, rows))
        assert found == expected
        assert found.to_json() == expected.to_json()
        measured += sum(one.robustness is not None for one in found.attempts)
    assert measured > 10


def test_without_requirements_there_is_nothing_to_measure():
    spec = rvmon.loads("spec s\nsignal x : real\n")
    found = spec.robustness(arrays_of([0, 1], {"x": [3.0, 2.0]}))
    assert (found.attempts, found.streams) == ({}, {})
    monitor = spec.robustness_monitor()
    assert not monitor.step(0, {"x": 1.0})
    assert not monitor.finish(1)


def test_a_stream_of_arrays_is_a_sequence():
    """The bounds differ only where input is unknown and near the end of the trace."""
    text = "time sampled\nsignal x : real\nrequirement R\n  upon start then within 1 ns x > 1\n"
    trace = arrays_of(range(6), {"x": [1.0, 2.0, np.nan, 3.0, 4.0, 6.0]})
    stream = rvmon.loads(text).robustness(trace).streams["R"]
    inf = np.inf
    assert list(stream.times) == list(range(6))
    assert list(stream.low) == [1.0, 1.0, 2.0, 3.0, 5.0, 5.0]
    assert list(stream.high) == [1.0, inf, inf, 3.0, 5.0, inf]
    assert list(stream.kept) == [1.0, 1.0, 2.0, 3.0, 5.0, 5.0]
    figures = [(one.low, one.high, one.kept) for _, one in stream]
    assert figures == list(zip(stream.low, stream.high, stream.kept, strict=True))
    assert len(stream) == 6
    assert list(stream[1:]) == list(stream)[1:]
    assert stream[-1] == list(stream)[-1]
