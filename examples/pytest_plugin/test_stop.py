"""Tests of a base: `pytest` judges the run of each test, and each recording, by `stop.rv`."""

import pytest


def drive(braking, seconds=3.0, step_s=0.05):
    """Samples of a base that is requested to stop after a second."""
    t, speed = 0.0, 0.8
    while t <= seconds:
        yield t, {"speed": speed, "stop_request": abs(t - 1.0) < step_s / 2}
        if t >= 1.0:
            speed = max(0.0, speed - braking * step_s)
        t += step_s


@pytest.mark.parametrize("braking", [2.0, 4.0])
def test_it_stops(rv, braking):
    base = rv("stop.rv", strict=True)
    for t, values in drive(braking):
        base.step(t, values)


def test_weak_brakes_are_found(rv):
    base = rv("stop.rv", expect={"S1": "F"})
    for t, values in drive(braking=1.0):
        base.step(t, values)
