"""Clocks of senders that differ from the log's are told, with how far."""

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
    """A bag of two topics with headers so many ms before the log, by the number of the message."""
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


def test_clocks_that_agree_are_not_spoken_of(tmp_path):
    path = recording(tmp_path / "a.bag", lambda n: 3 + n % 40, lambda n: 900 if n % 50 == 7 else 1)
    assert doubts(path, tmp_path) == {}


def test_a_clock_that_is_behind_another(tmp_path):
    path = recording(tmp_path / "a", lambda n: 1500 + n % 7, lambda n: 2 + n % 5, write=ros2)
    expected = (
        "headers are at least 1.5 s earlier than the log, those of another topic 0.002 s; "
        "do the clocks agree?"
    )
    assert doubts(path, tmp_path) == {"/odom": expected}
    assert doubts(path, tmp_path, clock="header") == {"/odom": expected}


def ros2(path, sent):
    return write_ros2(path, sent, "sqlite3")


def test_a_clock_that_is_ahead_of_the_log(tmp_path):
    path = recording(tmp_path / "a.bag", lambda n: -20 + n % 3, lambda _: 1)
    found = doubts(path, tmp_path)
    assert found == {"/odom": "headers are up to 0.02 s later than the log; do the clocks agree?"}


@pytest.mark.parametrize(("sign", "word"), [(1, "further from"), (-1, "nearer to")])
def test_a_clock_that_drifts(tmp_path, sign, word):
    path = recording(tmp_path / "a.bag", lambda n: 50 + sign * n / 10 + n % 2, lambda _: 1)
    found = doubts(path, tmp_path)
    assert list(found) == ["/odom"]
    assert f"s {word} the log; do the clocks agree?" in found["/odom"]


def test_headers_that_nobody_filled_in_say_nothing(tmp_path):
    zero = {"stamp": {"sec": 0, "nanosec": 0}}
    sent = [("/odom", START + n, {"header": zero}) for n in range(300)]
    assert doubts(write_ros1(tmp_path / "a.bag", sent), tmp_path, allow_missing=True) == {}
    path = recording(tmp_path / "b.bag", lambda _: 1500, lambda _: 1, count=9)
    assert doubts(path, tmp_path) == {}


def test_the_command_says_it(tmp_path, says):
    path = recording(tmp_path / "a.bag", lambda _: 1500, lambda _: 1)
    (tmp_path / "s.rv").write_text(SPEC)
    (tmp_path / "b.toml").write_text(BINDING)
    words = ["run", str(tmp_path / "s.rv"), str(path), "--binding", str(tmp_path / "b.toml")]
    told = " ".join(says(0, *words).out.split())
    assert "/odom warning: headers are at least 1.5 s earlier than the log" in told
    assert "`/odom`: headers are at least 1.5 s earlier" in says(0, *words, "--format", "json").err
