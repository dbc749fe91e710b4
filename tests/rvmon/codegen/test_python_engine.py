"""Generated Python monitors against the oracle, and as monitors."""

from collections import UserDict, defaultdict

import pytest
from tests.tools.differential import campaign
from tests.tools.forms import Maker

import rvmon
from rvmon.codegen import python_nodes, python_visit
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

TEXT = """
spec door "A door"
signal closed : bool input
signal width  : real [m]  stale after 3 s
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "It stays narrow"
  always width < 1 m
"""


@pytest.mark.law
@pytest.mark.parametrize("known", [True, False])
def test_the_oracle_agrees(known):
    """Verdicts, instants and what each call returned are as the law has them."""
    seeds = [f"generated/{known}/{number}" for number in range(25)]
    profile = Profile(mixed=False)
    tally = campaign(
        Maker("python"), seeds, profile, TraceProfile(unknowns=not known), online_every=5
    )
    assert tally.pairs == 25
    assert not tally.disagreements, tally.disagreements[0]


@pytest.mark.law
@pytest.mark.parametrize("known", [True, False])
def test_the_oracle_agrees_where_formulas_are_many(monkeypatch, known):
    """As above, with the code that is written where there are too many to look at one by one."""
    monkeypatch.setattr(python_visit, "_STRAIGHT", 0)
    monkeypatch.setattr(python_nodes, "_WATCHED", 0)
    seeds = [f"many/{known}/{number}" for number in range(15)]
    profile = Profile(mixed=False)
    tally = campaign(Maker("python"), seeds, profile, TraceProfile(unknowns=not known))
    assert tally.pairs == 15
    assert not tally.disagreements, tally.disagreements[0]


def test_records_and_health_are_those_of_the_other_engines():
    """Reasons, blame, values at the trigger and input health do not depend on the engine."""
    samples = [
        (0, {"closed": True}),
        (1, {"knock": True, "width": 0.5}),
        (2, {"width": float("nan")}),
        (3, {"width": 0.25, "knock": True}),
        (8, {"closed": None}),
        (9, {"closed": False, "width": 2.0}),
    ]
    reports = []
    for engine in ("python", "automaton"):
        monitor = rvmon.loads(TEXT).monitor(engine=engine)
        for t, values in samples:
            monitor.step(t, values)
        reports.append(monitor.finish(20))
    assert reports[0] == reports[1]
    assert {entry.kind for entry in reports[0].health} == {"missing", "nan", "none", "stale"}


def test_a_bound_step_survives_reset_and_finish():
    """The method of a monitor, once looked up, stays right over several runs."""
    monitor = rvmon.loads(TEXT).monitor(only=["D1"])
    step = monitor.step_ns
    for _ in range(2):
        step(0, {"closed": True, "knock": True})
        [failed] = step(5 * 10**9, {"closed": False})
        assert (failed.number, failed.decided, failed.verdict) == (1, 2 * 10**9 + 1, "F")
        monitor.finish_ns()
        with pytest.raises(rvmon.TraceError, match="finished"):
            step(6 * 10**9, {})
        monitor.reset()


def test_wrong_samples_leave_the_monitor_as_it_was():
    """A wrong name, type or time is refused with its cause, and the run goes on."""
    monitor = rvmon.loads(TEXT).monitor()
    monitor.step_ns(5, {"closed": True})
    for t, values, message in [
        (6, {"closed": 1}, "expected True or False"),
        (6, {"door": True}, "no signal or event named `door`"),
        (6, {"width": "wide"}, "expected a number"),
        (5, {"closed": False}, "not after"),
        (6.5, {"closed": False}, "whole number"),
        (1 << 62, {}, "out of range"),
    ]:
        with pytest.raises(rvmon.RvmonError, match=message):
            monitor.step_ns(t, values)
    monitor.step_ns(6, {"knock": True, "width": 1})
    assert [attempt.requirement for attempt in monitor.open] == ["D1"]


@pytest.mark.slow
def test_many_names_are_taken_entry_by_entry():
    """A specification with many signals judges as one with few."""
    many = "\n".join(f"signal s{n} : real" for n in range(30))
    rules = "\n".join(
        f'requirement R{n} "r"\n  whenever s{n} > 1\n  then within 2 s s{n} < 0' for n in range(30)
    )
    spec = rvmon.loads(f'spec many "m"\n{many}\n{rules}\n')
    found = []
    for engine in ("python", "automaton"):
        monitor = spec.monitor(engine=engine)
        for t in range(200):
            monitor.step(t, {f"s{t % 30}": float(t % 7 - 3), f"s{t % 11}": (t % 5) - 2})
        found.append(monitor.finish(300))
    assert found[0] == found[1]
    assert {"P", "F"} <= {attempt.verdict for attempt in found[0].attempts}


NO_SAMPLES = [5, None, "x", "ab", ["closed", "width"], ("a", "b", "c"), {"closed"}, 2.5, object()]


@pytest.mark.parametrize("engine", ["python", "automaton", "progression", "network"])
@pytest.mark.parametrize("values", NO_SAMPLES, ids=lambda value: type(value).__name__)
def test_what_holds_no_values_by_name_is_refused(engine, values):
    """Whatever stands where a mapping belongs, the error says so, and the run goes on."""
    monitor = rvmon.loads(TEXT).monitor(engine=engine)
    for t in (0, 7):
        with pytest.raises(rvmon.TraceError, match="expected values by name"):
            monitor.step_ns(t + 1, values)
        monitor.step_ns(t + 2, {"closed": True})
    assert monitor.finish_ns().end == 9


def test_values_are_taken_from_any_mapping():
    """What a sample holds is asked for by name, also where it comes one name at a time."""
    found = []
    for wrap in (dict, UserDict):
        monitor = rvmon.loads(TEXT).monitor()
        rows = [{"closed": True, "width": 0.5}, {"knock": True}, {}, {"width": 2.0}, {"width": 2.0}]
        decided = [monitor.step(t, wrap(row)) for t, row in enumerate(rows)]
        found.append(([[one.decided for one in step] for step in decided], monitor.finish()))
    assert found[0] == found[1]
    assert [len(step) for step in found[0][0]] == [0, 0, 0, 1, 1]


@pytest.mark.parametrize("values", [[], "", b"", set(), ()])
def test_what_is_empty_and_no_mapping_is_refused(values):
    """Nothing is a sample that brings nothing but a mapping that holds nothing."""
    monitor = rvmon.loads(TEXT).monitor(engine="python")
    monitor.step(0, {"closed": True, "width": 0.5})
    with pytest.raises(rvmon.TraceError):
        monitor.step_ns(10**9, values)


def test_a_mapping_that_invents_values_is_asked_for_what_it_holds():
    """An unknown name is refused, and nothing is added."""
    values = defaultdict(float, {"closed": True, "widht": 0.5})
    monitor = rvmon.loads(TEXT).monitor(engine="python", sources=["closed", "width"])
    monitor.step(0, {"closed": True, "width": 0.5})
    with pytest.raises(rvmon.TraceError, match="widht"):
        monitor.step(1, values)
    assert len(values) == 2
