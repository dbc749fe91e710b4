"""JSON lines as live input."""

import os

import pytest
from tests.tools.each import each

from rvmon import Verdict, loads
from rvmon.adapters.json_objects import (
    PROLOGUE,
    JsonObjects,
    decoded_object,
    feed_lines,
    first_lines,
    read_lines,
)
from rvmon.errors import TraceError
from rvmon.live import Driver, SimulatedClock
from rvmon.recordings.jsonl_rows import MORE, MOST_NAMES

SPEC = """
spec s
signal x : real
event a
requirement R
  always x <= 1
"""


@pytest.fixture
def live():
    """A driver, its clock and a reader of lines with stamps."""
    spec, clock = loads(SPEC), SimulatedClock()
    driver = Driver(spec, clock=clock)
    return driver, clock, JsonObjects(driver, clock=clock)


def _verdicts(driver, lines, source, robot=None):
    feed_lines(source, lines, robot)
    while driver.work() == 0:
        pass
    driver.close()
    return {name: status.verdicts["R"] for name, status in driver.status().items()}


def test_the_clock_follows_the_stamps(live):
    """A late line does not set it back; a line of another run does."""
    driver, clock, source = live
    lines = [b'{"t": 20, "x": 0}', b'{"t": 19.5, "a": true}', b'{"t": 1, "x": 2}']
    feed_lines(source, lines[:2])
    assert clock.now_ns() == 20_000_000_000
    assert _verdicts(driver, lines[2:], source) == {"": Verdict.FAIL}
    assert driver.status()[""].run == 2


LEFT = [b'{"t": 1, "id": "left", "x": 1}', b'{"t": 2, "id": "left", "x": 1}']


@each(
    ("lines", "robot", "unread", "verdicts"),
    [
        # A line that cannot be read may have held anything.
        ([b'{"t": 0, "x": 0}', b"x: 7", b'{"t": 2}'], None, 1, {"": "I"}),
        # A line without a stamp is from some instant between its neighbours, perhaps late.
        ([b'{"t": 0, "x": 0}', b'{"x": 0}', b'{"t": 9, "x": 0}'], None, 1, {"": "I"}),
        # A line without a known robot may be of any robot, also of one that comes later.
        (LEFT, "id", 0, {"left": "P"}),
        ([b"torn {", *LEFT], "id", 1, {"left": "I"}),
        (
            [
                b'{"t": 0, "id": "left", "x": 0}',
                b'{"t": 0, "id": 2, "x": 3}',
                b'{"t": 0.5, "id": 2}',
                b'{"t": 1, "x": 0}',
                b'{"t": 2, "id": "left"}',
            ],
            "id",
            1,
            {"left": "I", "2": "F"},
        ),
    ],
)
def test_what_a_line_does_not_say_is_unknown(lines, robot, unread, verdicts):
    clock = SimulatedClock()
    source = JsonObjects(driver := Driver(loads(SPEC), clock=clock), clock=clock)
    assert _verdicts(driver, lines, source, robot) == verdicts
    assert source.unread == unread


@pytest.mark.parametrize(("waits", "verdict"), [(True, "NT"), (False, "F")])
def test_names_that_only_a_later_specification_declares_are_read(live, waits, verdict):
    """From its start on; lines waiting at that time are judged by the former specification."""
    driver, _, source = live
    feed_lines(source, [b'{"t": 0, "x": 0}'])
    later = loads("signal y : real\nevent b\nrequirement R\n  upon b\n  then y <= 1")
    lines = [b'{"t": 1, "y": 2, "b": true}']
    if waits:
        feed_lines(source, lines)
        driver.replace_spec(later)
        lines = []
    else:
        driver.replace_spec(later)
    feed_lines(source, [*lines, b'{"t": 2}'])
    driver.close()
    former, latter = driver.close()[""]
    assert [one.verdict.value for one in former.attempts] == ["P"]
    assert latter.verdicts == {"R": verdict}


def test_a_name_that_a_declared_one_may_be_meant_by_is_told_at_once(live, caplog):
    driver, _, source = live
    _verdicts(driver, [b'{"t": 0, "state": {"x": 0}, "y": 1}', b'{"t": 1, "state.x": 0}'], source)
    [told] = [one.getMessage() for one in caplog.records if "feeds nothing" in one.getMessage()]
    assert told == "`state.x` feeds nothing, and `x` is declared: is `--map x=state.x` meant?"


def test_undeclared_names_are_counted_in_bounded_memory(live):
    """With new names in each line, a limited number is listed, the others are counted together."""
    driver, _, source = live
    lines = [b'{"t": %d, "x": 0, "y%d": 1}' % (number, number) for number in range(1_200)]
    assert _verdicts(driver, [*lines, b""], source) == {"": Verdict.PASS}
    assert len(source.ignored) == MOST_NAMES + 1
    assert source.ignored["y0"] == 1
    assert source.ignored[MORE] == 200


def test_lines_without_a_time_are_stamped_as_they_arrive():
    driver = Driver(loads(SPEC), clock=SimulatedClock(7))
    assert _verdicts(driver, [b'{"x": 2}'], JsonObjects(driver)) == {"": Verdict.FAIL}
    assert driver.close()[""][0].attempts[0].decided == 7


def test_a_stamp_of_another_epoch_is_reported_and_ignored():
    """The clock runs by itself: the content of the line is unknown, the next one is judged."""
    source = JsonObjects(driver := Driver(loads(SPEC)))
    lines = [b'{"x": 0}', b'{"x": 0, "t": 1800000000}', b'{"x": 2}']
    assert _verdicts(driver, lines, source) == {"": Verdict.FAIL}
    assert source.unread == 1


def test_lines_that_come_after_the_end_are_nobodys(live):
    driver, _, source = live
    driver.close()
    feed_lines(source, iter([b'{"t": 0, "x": 0}', b"nonsense"]))
    assert source.unread == 0


def test_lines_are_read_as_they_come():
    """A pipe delivers them in pieces, and the last one may lack its end.

    Programs on Windows start files with a byte order mark, which is not part of a line.
    """
    read, write = os.pipe()
    lines = read_lines(read)
    os.write(write, b'\xef\xbb\xbf{"t": 1}\n{"t"')
    assert next(lines) == b'{"t": 1}'
    os.write(write, b": 2}")
    os.close(write)
    assert list(lines) == [b'{"t": 2}']
    os.close(read)


@pytest.mark.parametrize(
    ("lines", "taken", "stamp"),
    [
        ([b'{"t_ns": 5}', b"more"], 1, 5),
        ([b'{"x": 5}', b'{"t_ns": 5}'], 1, None),
        ([b"[INFO] hello", b"", b'{"level": 1}', b'{"t_ns": 5}', b"more"], 4, 5),
        ([b"nonsense"] * PROLOGUE + [b'{"t_ns": 5}'], PROLOGUE, None),
        ([], 0, None),
    ],
)
def test_the_first_object_decides_whether_lines_have_stamps(lines, taken, stamp):
    """Lines before it do not; all lines read are passed on."""
    assert first_lines(iter(lines), loads(SPEC).schema) == (lines[:taken], stamp)


def test_an_overlong_line_is_cut_into_pieces(tmp_path, monkeypatch):
    """So it takes little memory, and later lines are read."""
    monkeypatch.setattr("rvmon.adapters.json_objects.LONGEST_LINE", 1 << 18)
    path = tmp_path / "run.jsonl"
    path.write_bytes(b'{"t": 0}\n' + b"x" * (1 << 20) + b'\n{"t": 1}\n')
    with path.open("rb") as file:
        lines = list(read_lines(file.fileno()))
    assert (lines[0], lines[-1]) == (b'{"t": 0}', b'{"t": 1}')
    assert max(map(len, lines)) < 1 << 19
    assert b"".join(lines[1:-1]) == b"x" * (1 << 20)


@each(
    ("text", "why"),
    [
        (b"t,speed\n", "`rvmon run` reads CSV"),
        (b'{"t": 0, ', "^(?!.*CSV)"),
        (b'{"x": ' + b"[" * 100_000, "too deeply"),
        (b'{"x": "\\ud800"}', "half of a surrogate pair"),
    ],
)
def test_messages_about_lines_that_are_not_objects(text, why):
    """As of `rvmon run`; for rows of CSV the message names the command that reads them."""
    with pytest.raises(TraceError, match=why):
        decoded_object(text)
