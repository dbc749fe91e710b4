"""Whole recordings are measured alike, by arrays or sample by sample."""

import random

import numpy as np
import pytest

import rvmon
from rvmon.recordings.source import Source
from rvmon.trace.sample import Trace

PAIRS = 40
COMPARED = ("<", "<=", "==", "!=", ">=", ">")
STEPS = ("X", "Y")
TIMED = ("F", "G", "O", "H", "U", "S", "R")


def random_formula(rng, depth, others):
    """The text of a formula over two numbers and an event, with other operators beside."""
    if not depth:
        number = f"{rng.choice('xy')} {rng.choice(COMPARED)} {rng.randint(-3, 3)}"
        return "e" if rng.random() < 0.2 else number
    op = rng.choice(("not", "and", "or", *TIMED, *others))
    low = rng.choice((0, 0, 2))
    high = rng.choice(("inf)", f"{low} ns]", f"{low + 3} ns]"))
    window = f"[{low} ns, {high}" if op in TIMED else ""
    one = random_formula(rng, depth - 1, others)
    if op in ("not", *STEPS, *TIMED[:4]):
        return f"({op}{window} ({one}))"
    return f"(({one}) {op}{window} ({random_formula(rng, rng.randrange(depth), others)}))"


def random_case(rng, time, unknown):
    """A specification, and a trace of many rows as columns, in which little occurs."""
    trigger = rng.choice(("upon start", "upon end", "upon x > 1", "whenever y <= 0", "upon e"))
    required = random_formula(rng, rng.randint(0, 3), STEPS if time == "sampled" else ())
    spec = rvmon.loads(
        f"spec whole\ntime {time}\nsignal x, y : real\nevent e\n"
        f"requirement R\n  {trigger}\n  then {required}\n"
    )
    gaps = rng.choice(((1, 1, 2, 3, 5), (1,), (2,), (3,)))  # evenly spaced rows go another way
    times = np.cumsum(rng.choices(gaps, k=rng.randint(70, 300)))
    columns = {
        name: [np.nan if rng.random() < unknown else float(rng.randint(-4, 4)) for _ in times]
        for name in "xy"
    }
    columns["e"] = [rng.random() < 0.01 for _ in times]
    return spec, times.tolist(), columns


def rows_of(times, columns):
    """The same trace as pairs."""
    for row, t in enumerate(times):
        yield t * 1e-9, {name: column[row] for name, column in columns.items()}


def arrays_of(times, columns):
    return {name: np.array(column) for name, column in {"t_ns": times, **columns}.items()}


def figures_of(margins):
    streams = {name: list(stream) for name, stream in margins.streams.items()}
    return dict(margins.attempts), dict(margins.doubtful), streams


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize("unknown", [0.0, 0.01])
def test_many_rows_that_change_no_verdict_are_measured_as_their_samples_are(time, unknown):
    for number in range(PAIRS // 4):
        rng = random.Random(f"long {time} {number}")
        spec, times, columns = random_case(rng, time, unknown)
        found = spec.robustness(arrays_of(times, columns))
        expected = spec.robustness(rows_of(times, columns))
        assert figures_of(found) == figures_of(expected), f"{spec}\n{times}\n{columns}"


def test_without_requirements_there_is_nothing_to_measure():
    spec = rvmon.loads("spec s\nsignal x : real\n")
    found = spec.robustness(arrays_of([0, 1], {"x": [3.0, 2.0]}))
    assert (found.attempts, found.streams) == ({}, {})
    monitor = spec.robustness_monitor()
    assert not monitor.step(0, {"x": 1.0})
    assert not monitor.finish(1)


TEXT = "spec s\ntime {}\nsignal x : real{}\nrequirement R\n  upon start then immediately x > 1\n"


def test_what_becomes_stale_is_measured_sample_by_sample():
    spec = rvmon.loads(TEXT.format("held", " stale after 2 ns").replace("immed", "for 5 ns immed"))
    [figure] = spec.robustness(arrays_of([0, 9], {"x": [3.0, 4.0]})).attempts.values()
    assert (figure.low, figure.high) == (-float("inf"), 2.0)


def test_a_stream_of_arrays_is_a_sequence():
    """One figure is picked like any other element, several are a stream."""
    spec = rvmon.loads(TEXT.format("sampled", ""))
    stream = spec.robustness(arrays_of([0, 1, 2], {"x": [1.0, 2.0, 3.0]})).streams["R"]
    assert len(stream) == 3
    assert list(stream[1:]) == list(stream)[1:]
    assert stream[-1] == list(stream)[-1]


@pytest.mark.slow
@pytest.mark.parametrize(("time", "end"), [("held", None), ("sampled", 1_200_500_000_000)])
def test_a_recording_is_judged_and_measured_alike_by_columns_and_by_rows(time, end, tmp_path):
    spec = rvmon.loads(
        f"spec s\ntime {time}\nsignal x : real\nsignal p : bool\n"
        "requirement R1\n  upon rise(p)\n  then within 3 s x > 9\n"
        "requirement R2\n  whenever p\n  then x < 9.5\nrequirement R3\n  always x < 9.99\n"
    )
    rng = random.Random(1)
    path = tmp_path / "run.csv"
    rows = (f"{3 * t // 2},{rng.uniform(0, 10):.3f},{rng.randrange(2)}" for t in range(1000))
    path.write_text("\n".join(["t,x,p", *rows, ""]))

    def judged(recording):
        return spec.judge(Source(recording, end, is_cut=True), robustness=True)

    read = spec.recording(path)
    found, expected = judged(spec.recording(path)), judged(Trace((*read,), read.names, read.end))
    assert found == expected
    assert found.to_json() == expected.to_json()
    assert all(one.robustness is not None for one in found.attempts if one.decided is not None)
