"""Clocks of senders that differ from the log's are reported with their offset."""

from functools import partial

import pytest
from tests.tools.bags import START, write_ros1, write_ros2

import rvmon
from rvmon.trace.sample import HealthKind

pytestmark = pytest.mark.slow

pytest.importorskip("rosbags")

SPEC = """spec s
signal odom : real
signal scan : int
requirement R
  always odom < 2
requirement S
  always scan < 2
"""
BINDING = """[bind.odom]
topic = "/odom"
value = "twist.twist.linear.x"
[bind.scan]
topic = "/base/scan"
value = "state"
"""


def recording(path, odom, scan, *, write=write_ros1, count=400):
    """A bag of two topics with headers some ms before the log, by the number of the message."""
    sent = []
    for number in range(count):
        t = START + number * 10**8
        for topic, late in (("/odom", odom), ("/base/scan", scan)):
            stamp = t - int(late(number) * 1e6)
            header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}}
            sent.append((topic, t, {"header": header} if late(number) is not None else {}))
    return write(path, sent)


def doubts(path, tmp_path, **arguments):
    (tmp_path / "b.toml").write_text(BINDING)
    spec = rvmon.loads(SPEC)
    report = spec.evaluate(path, binding=tmp_path / "b.toml", **arguments)
    return {one.name: one.remark for one in report.health if one.kind is HealthKind.CLOCK}


BEHIND = "headers are at least 1.5 s earlier than the log, those of another topic 0.002 s; "


@pytest.mark.parametrize(
    ("odom", "scan", "remark"),
    [
        (lambda n: 3 + n % 40, lambda n: 900 if n % 50 == 7 else 1, ""),
        (lambda n: 1500 + n % 7, lambda n: 2 + n % 5, BEHIND),
        (lambda n: -20 + n % 3, lambda _: 1, "headers are up to 0.02 s later than the log; "),
        (lambda n: 50 + n / 10 + n % 2, lambda _: 1, "s further from the log; "),
        (lambda n: 50 - n / 10 + n % 2, lambda _: 1, "s nearer to the log; "),
    ],
    ids=["agree", "behind", "ahead", "drifts away", "drifts back"],
)
@pytest.mark.parametrize("is_ros_2", [False, True])
def test_a_clock_that_differs_is_told(tmp_path, odom, scan, remark, is_ros_2):
    write = partial(write_ros2, plugin="sqlite3") if is_ros_2 else write_ros1
    path = recording(tmp_path / ("a" if is_ros_2 else "a.bag"), odom, scan, write=write)
    for clock in ("log", "header"):
        found = doubts(path, tmp_path, clock=clock)
        assert [*found] == ["/odom"] * bool(remark)
        assert all(f"{remark}do the clocks agree?" in one for one in found.values())


def test_headers_that_nobody_filled_in_or_few_have_say_nothing(tmp_path):
    zero = {"stamp": {"sec": 0, "nanosec": 0}}
    sent = [("/odom", START + n, {"header": zero}) for n in range(300)]
    assert doubts(write_ros1(tmp_path / "a.bag", sent), tmp_path, allow_missing=True) == {}
    path = recording(tmp_path / "b.bag", lambda _: 1500, lambda _: 1, count=9)
    assert doubts(path, tmp_path) == {}
