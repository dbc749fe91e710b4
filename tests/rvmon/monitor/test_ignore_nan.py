"""Signals that ignore NaN: in every format, NaN is as if it were absent."""

import math

import pytest

import rvmon
from rvmon.errors import TraceError
from rvmon.trace.sample import HealthKind

SPEC = """spec lidar
time {time}
signal range : real [m] input ignore NaN stale after 500 ms
signal free  : real [m] input ignore NaN
event  look

requirement Near
  always (range < 1 m -> free < 2 m)
requirement Fresh
  upon look
  then immediately known(range)
requirement Heard
  upon updated(range)
  then within 1 s look
requirement Steady
  always abs(rate(free)) <= 5 m/s
requirement Young
  upon age(range) > 300 ms
  then within 1 s look
"""
NAN = math.nan
ROWS = [
    (0.0, {"range": 2.0, "free": 3.0}),
    (0.1, {"range": NAN, "free": NAN}),
    (0.2, {"range": 0.5, "free": 1.0, "look": True}),
    (0.4, {"range": NAN}),
    (0.6, {"range": NAN, "free": 1.5, "look": True}),
    (0.7, {"range": NAN, "free": NAN}),
    (0.9, {"range": NAN, "free": 2.5, "look": True}),
    (1.5, {"range": 3.0, "free": NAN}),
]


@pytest.fixture(params=["held", "sampled", "sampled every 100 ms"])
def spec(request):
    return rvmon.loads(SPEC.format(time=request.param))


def records(report):
    """The records without their reasons."""
    return report.verdicts, [
        (a.requirement, a.number, a.triggered, a.decided, a.verdict) for a in report.attempts
    ]


@pytest.mark.slow
def test_the_signal_goes_stale_after_its_last_good_value(spec):
    """Not at the first NaN, and not counted from one; until then the value stays.

    The NaN is not a finding of input health; the stale signal is.
    """
    report = spec.evaluate(ROWS)
    assert [a.verdict for a in report.attempts if a.requirement == "Fresh"] == ["P", "P", "F"]
    assert [a.verdict for a in report.attempts if a.requirement == "Heard"] == ["P", "P", "I"]
    assert report.verdicts["Near"] in ("P", "I")
    assert {one.kind for one in report.health} == {HealthKind.STALE}


def test_files_are_judged_as_samples(spec, tmp_path):
    """Also if NaN has the stamp of a value: there is no conflict, and the value stays."""
    lines = ["t,range,free,look"]
    for t, row in ROWS:
        lines.append(f"{t},{row['range']},{row.get('free', '')},{int('look' in row)}")
        lines.append(f"{t},nan,nan,0")
    (tmp_path / "a.csv").write_text("\n".join(lines))
    looks = [(t, {"look": False, **row}) for t, row in ROWS]
    report = spec.evaluate(tmp_path / "a.csv")
    assert records(report) == records(spec.evaluate(looks))
    assert HealthKind.CONFLICT not in {one.kind for one in report.health}


def test_samples_that_are_merged_keep_the_value(spec):
    monitor = spec.monitor(settle="next")
    for t, row in ROWS:
        monitor.step(t, row)
        monitor.step(t, {"range": NAN, "free": None})
    with pytest.raises(TraceError, match="expected a number"):
        monitor.step(2.0, {"range": "far"})
    report = monitor.finish()
    assert records(report) == records(spec.evaluate(ROWS))
    assert HealthKind.CONFLICT not in {one.kind for one in report.health}
