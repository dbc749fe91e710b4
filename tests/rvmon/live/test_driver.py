"""Samples of running robots, evaluated on a clock that only the test moves."""

import logging

import pytest
from tests.tools.each import each

from rvmon import RvmonError, TraceError, Verdict, loads
from rvmon.errors import UnknownNameError
from rvmon.live import Driver, SimulatedClock
from rvmon.trace.sample import HealthKind

S = 1_000_000_000
DOOR = """
spec door
signal speed : real
event knock, opened
requirement D1 upon knock then within 2 s opened
requirement D2 always speed <= 1
"""


class Door:
    """A driver of the door, its clock, and the names of decided attempts."""

    def __init__(self, text: str = DOOR, **options) -> None:
        self.clock = SimulatedClock()
        self.judged = []
        options.setdefault("on_judged", lambda one: self.judged.append(one.attempt.name))
        self.driver = Driver(loads(text), clock=self.clock, **options)

    def at(self, seconds: float) -> None:
        """Move the clock to an instant and evaluate what waits."""
        self.clock.set_ns(round(seconds * S))
        while self.driver.work() == 0:
            pass

    def hears(self, seconds: float, robot: str = "", **values) -> bool:
        """Move the clock to an instant and offer a sample; returns whether it is taken."""
        self.at(seconds)
        return self.driver.offer(values, robot=robot)

    def ended(self, seconds: float) -> str:
        """Close at an instant; returns the verdicts of the only run, in the order of the file."""
        self.at(seconds)
        (report,) = self.driver.close()[""]
        return " ".join(report.verdicts.values())


def test_time_alone_decides_a_missed_deadline():
    door = Door()
    door.hears(0, knock=True)
    door.at(2)
    (required,) = [one for one in door.driver.status()[""].open if one.requirement == "D1"]
    assert (door.judged, required.deadline) == ([], 2 * S)
    door.clock.set_ns(2 * S + 1)
    assert door.driver.work() is None
    assert door.judged == ["D1#1"]


def test_each_robot_has_its_own_verdicts_and_only_failures_reach_on_failure():
    failed = []
    door = Door(on_failure=failed.append)
    door.hears(0, "left", knock=True, speed=2.0)
    door.hears(0, "right", knock=True)
    door.hears(1, "left", opened=True)
    door.at(3)
    assert door.judged == ["D2#1", "D1#1", "D1#1"]
    found = [(failure.robot, failure.run, failure.attempt.name) for failure in failed]
    assert found == [("left", 1, "D2#1"), ("right", 1, "D1#1")]
    assert failed[0].to_dict()["decided"] == 0
    found = {name: reports[0].verdicts["D1"] for name, reports in door.driver.close().items()}
    assert found == {"left": "P", "right": "F"}


def test_samples_of_a_robot_above_the_limit_are_refused(caplog):
    door = Door(most_robots=1)
    assert door.hears(0, "left", speed=0.0)
    with caplog.at_level(logging.WARNING, "rvmon.live.input"):
        assert not door.hears(0, "right", speed=9.0)
        assert not door.hears(0, "more", speed=9.0)
    assert door.hears(0, "left", speed=0.5)
    door.at(1)
    assert list(door.driver.status()) == ["left"]
    assert door.driver.turned_away
    assert len(caplog.records) == 1


def test_a_sample_without_room_leaves_verdicts_open_that_need_it():
    """The lost sample may have opened the door (no F) or shown a high speed (no P)."""
    door = Door(room=2)
    door.driver.offer({"speed": 0.5})
    door.driver.offer({"speed": 0.5, "knock": True})
    assert not door.driver.offer({"opened": True, "speed": 5.0})
    door.at(9)
    status = door.driver.status()[""]
    assert (status.samples, status.lost) == (2, 1)
    (report,) = door.driver.close()[""]
    assert [*report.verdicts.values()] == ["I", "I"]
    dropped = [entry for entry in report.health if entry.kind is HealthKind.DROPPED]
    found = [(entry.name, *entry.requirements) for entry in dropped]
    assert found == [("opened", "D1"), ("speed", "D2")]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["real", "real ignore NaN"])
def test_a_lost_first_value_is_no_excuse(kind):
    """Nothing is required before the first value, but the lost sample may have had one."""
    door = Door(DOOR.replace("real", kind), room=1)
    door.hears(0, knock=False)
    assert not door.driver.offer({"speed": 5.0})
    door.hears(1, speed=0.5)
    assert door.ended(2) == "NT I"


def test_many_lost_samples_take_one_entry_of_the_queue():
    door = Door(room=1)
    for _ in range(5_002):
        door.driver.offer({"knock": True})
    assert door.driver.waiting == 2
    door.at(1)
    assert door.driver.status()[""].lost == 5_001
    assert door.ended(1) == "I I"


@pytest.mark.parametrize(("knocks_at", "expected"), [(3, "F"), (1.5, "I")])
def test_events_are_unknown_while_the_connection_is_down(knocks_at, expected):
    door = Door()
    door.hears(0, speed=0.5, opened=False)
    door.at(1)
    door.driver.lose(why="the connection is down")
    door.at(2)
    if knocks_at == 1.5:
        door.driver.offer({"knock": True})
    door.at(3)
    door.driver.found()
    door.clock.set_ns(3 * S + 2)
    if knocks_at == 3:
        door.driver.offer({"knock": True})
    assert door.ended(9) == f"{expected} I"


def test_missed_samples_of_one_robot_do_not_affect_another():
    """Without the name of a robot, all robots missed them."""
    door = Door()
    for robot in ("left", "right"):
        door.hears(0, robot, speed=0.5)
    door.at(1)
    door.driver.miss(robot="left")
    door.driver.miss(["knock"])
    for robot in ("left", "right"):
        door.hears(2, robot, speed=0.5)
    reports = {name: found[0].verdicts for name, found in door.driver.close().items()}
    assert reports == {"left": {"D1": "I", "D2": "I"}, "right": {"D1": "I", "D2": "P"}}


@each("names", [None, ["opened"], ["knock", "speed", "opened"]])
@each("found", [False, True])
def test_lost_names_stay_lost_in_the_next_run(names, found):
    """Whether it starts with another specification or because the clock was set back."""
    door = Door()
    door.hears(0, speed=0.5)
    door.at(1)
    door.driver.lose(names, why="nobody listens")
    door.at(2)
    door.driver.replace_spec(loads(DOOR))
    if found:
        door.driver.found(names)
        door.clock.set_ns(2 * S + 1)
    for t in (3, 4):
        door.clock.set_ns(t * S)
        door.driver.offer({"speed": 0.5, "knock": True})
    door.at(7)
    door.clock.set_ns(1)
    door.hears(0.5, speed=0.5, knock=True)
    door.at(9)
    verdicts = [report.verdicts["D1"].value for report in door.driver.close()[""][-2:]]
    assert verdicts == (["F", "F"] if found else ["I", "I"])


def test_undeclared_names_cannot_be_lost():
    """A misspelt name is an error; lost names of the previous specification are forgotten."""
    door = Door()
    door.hears(0, speed=0.5)
    with pytest.raises(UnknownNameError, match="`speed`"):
        door.driver.lose(["sped"])
    door.driver.lose(["opened"])
    door.driver.miss(["opened", "knock"])
    door.driver.replace_spec(loads("signal speed : real\nrequirement R1\n  always speed <= 1\n"))
    door.hears(0, speed=0.5)
    door.at(1)
    assert door.driver.close()[""][-1].verdicts == {"R1": Verdict.PASS}


def test_a_loss_in_the_past_leaves_readers_of_its_names_open():
    door = Door()
    door.hears(0, speed=0.5)
    door.hears(5, speed=0.5)
    door.at(6)
    door.driver.lose(["speed"], since_ns=2 * S, is_over=True)
    door.hears(7, speed=0.5)
    assert door.ended(7) == "NT I"


def test_a_lost_sample_is_a_position_of_sampled_time():
    """`next` refers to the lost sample, whose values are unknown."""
    spec = "spec s\ntime sampled\nevent a, b, c\nrequirement R\n  upon a\n  then next b\n"
    door = Door(spec, room=1)
    for t, name in enumerate("abc"):
        door.driver.offer({name: True}, t_ns=t)
    door.at(3e-9)
    door.driver.offer({"c": True}, t_ns=3)
    assert door.ended(1) == "I"


@pytest.mark.parametrize(
    ("values", "why"), [({"sped": 1.0}, "no signal or event"), ({"speed": "fast"}, "a number")]
)
def test_a_refused_sample_is_lost_and_the_run_continues(values, why, caplog):
    door = Door()
    door.hears(0, speed=0.5)
    with caplog.at_level(logging.WARNING, "rvmon.live.input"):
        door.hears(1, **{"speed": 0.5, **values})
        door.at(2)
    assert why in caplog.text
    status = door.driver.status()[""]
    assert (status.lost, why in status.refusal) == (1, True)
    assert door.ended(2) == "NT I"


def test_a_sample_behind_the_clock_leaves_its_names_unknown():
    door = Door()
    door.hears(0, speed=0.5)
    door.at(5)
    door.driver.offer({"speed": 9.0}, t_ns=3 * S)
    door.at(6)
    (report,) = door.driver.close()[""]
    assert report.verdicts["D2"] is Verdict.INCONCLUSIVE
    assert [entry.count for entry in report.health if entry.kind is HealthKind.LATE] == [1]


def test_samples_within_the_lag_are_put_in_order_and_later_ones_lost():
    door = Door(lag_ns=2 * S)
    for now, t, name in ((0, 0, "knock"), (3, 4, ""), (3, 2, "opened"), (3, 5, "")):
        door.at(now)
        assert door.driver.offer({name: True} if name else {}, t_ns=t * S)
    door.at(9)
    status = door.driver.status()[""]
    assert (status.verdicts["D1"], status.lost) == (Verdict.PASS, 0)
    door.driver.offer({"opened": True}, t_ns=S)
    door.at(10)
    status = door.driver.status()[""]
    assert (status.verdicts["D1"], status.lost) == (Verdict.INCONCLUSIVE, 1)
    assert "it exceeds the allowed delay" in status.refusal


@each(("closed_at", "expected"), [(4, "I"), (4.1, "F")])
def test_closing_does_not_pass_deadlines_within_the_lag(closed_at, expected):
    door = Door(lag_ns=2 * S)
    door.hears(0, knock=True)
    door.clock.set_ns(round(closed_at * S))
    assert door.driver.close()[""][0].verdicts["D1"] == expected


def test_a_clock_that_goes_back_starts_a_new_run():
    """A simulation was restarted. The report of the first run has the reason; both runs count."""
    ended = []
    door = Door(on_report=lambda robot, report: ended.append((robot, report)))
    door.hears(0, speed=3.0)
    door.at(5)
    door.hears(0, speed=0.5)
    door.at(1)
    status = door.driver.status()[""]
    assert (status.run, status.verdicts["D2"]) == (2, Verdict.FAIL)
    ((robot, report),) = ended
    assert robot == ""
    assert "clock went back by 5 s" in report.health[-1].remark
    assert door.driver.close()[""][1].verdicts["D2"] is Verdict.PASS


def test_a_clock_that_leaps_by_years_starts_a_new_run(caplog):
    """A machine without a battery learns the time; no deadline passed in between."""
    door = Door(DOOR.replace("always speed", "always within 1 s speed"))
    door.hears(0, speed=3.0, knock=True)
    with caplog.at_level(logging.WARNING, "rvmon.live.input"):
        door.at(1_800_000_000)
    assert "went on by years" in caplog.text
    status = door.driver.status()[""]
    assert (status.run, *status.verdicts.values()) == (2, "I", "I")


def test_a_new_specification_applies_at_once_if_it_has_the_requested_requirements():
    door = Door(only=["D2"])
    door.hears(0, speed=1.5)
    with pytest.raises(UnknownNameError):
        door.driver.replace_spec(loads(DOOR.replace("D2", "D3")))
    door.at(1)
    door.driver.replace_spec(loads(DOOR.replace("<= 1", "<= 2")))
    door.hears(1, speed=1.5)
    door.at(2)
    assert door.driver.status()[""].verdicts == {"D2": Verdict.NOT_TRIGGERED}
    first, second = door.driver.close()[""]
    assert (first.verdicts["D2"], second.verdicts["D2"]) == (Verdict.FAIL, Verdict.PASS)


def test_an_exception_in_a_callback_is_logged_and_the_run_continues(caplog):
    door = Door(on_failure=lambda _: 1 // 0)
    with caplog.at_level(logging.ERROR, "rvmon.live"):
        for t, speed in enumerate((2.0, 0.0, 2.0)):
            door.hears(t, speed=speed)
        door.at(3)
    assert door.driver.errors == 2
    assert door.judged == ["D2#1", "D2#2"]
    assert "ZeroDivisionError" in caplog.text


def test_a_callback_may_read_the_status_but_not_drive():
    seen = []

    def look(_):
        seen.append(door.driver.status()[""].verdicts["D2"])
        for drive in (door.driver.work, door.driver.close):
            with pytest.raises(RvmonError, match="callback"):
                drive()

    door = Door(on_failure=look)
    door.hears(0, speed=2.0)
    door.at(1)
    assert (len(seen), door.driver.errors) == (1, 0)


def test_closing_evaluates_waiting_samples_and_is_final():
    door = Door()
    door.hears(0, speed=2.0)
    reports = door.driver.close()
    assert reports[""][0].verdicts["D2"] is Verdict.FAIL
    assert door.driver.close() == reports
    with pytest.raises(RvmonError, match="closed"):
        door.hears(0, speed=0.0)


@each(
    ("make", "message"),
    [
        (lambda: Door(room=0), "room"),
        (lambda: Driver("door.rv"), r"use `rvmon.load.'door.rv'.`"),
        (lambda: Door(only=["D9"]), "no requirement `D9`"),
        (lambda: Door(sources=["sped"]), "`sped`"),
    ],
)
def test_wrong_arguments_are_refused(make, message):
    with pytest.raises(RvmonError, match=message):
        make()


def test_stamps_far_ahead_of_the_clock_and_values_without_names_are_refused():
    driver = Driver(loads(DOOR))
    for seconds in (1_700_000_000, 3_600):
        with pytest.raises(TraceError, match="since_1970"):
            driver.offer({"speed": 0.0}, t_ns=seconds * S)
    with pytest.raises(TraceError, match="values by name"):
        driver.offer([1, 2])
