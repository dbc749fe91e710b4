"""Forecasts of open attempts: verdicts that no continuation, or every continuation, gives."""

import pytest
from hypothesis import given, settings
from tests.tools.each import each

from rvmon import loads
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision

pytestmark = pytest.mark.law

TEXT = "spec t\ntime {}\nsignal p, q, r : bool\nrequirement R\n  upon start then {}\n"


def forecast_of(formula, *samples, time="held"):
    """The forecast of an attempt after samples at whole seconds."""
    monitor = loads(TEXT.format(time, formula)).monitor()
    for t, values in enumerate(samples or [{"p": formula.startswith("p until"), "q": False}]):
        monitor.step(t, values)
    (attempt,) = monitor.open
    return attempt.forecast and attempt.forecast.value


CASES = {
    "eventually p": None,
    "always eventually p": None,
    "(eventually always p) and always eventually not p": "F",
    "(eventually p) or always not p": "P",
    "always (p or not p)": "P",
    "(within 3 s p) and for 5 s not p": "F",
    "(within 5 s p) and for 3 s not p": None,
    "(within 3 s p) or for 3 s not p": "P",
    "always within 3 s p": None,
    "(always within 3 s p) and eventually for 2 s not p": None,
    "p until (q and not q)": "F",
    "always eventually[2 s, inf) p": None,
}


CLOCKED = "sampled every 500 ms"


@each("time", ["held", "sampled", CLOCKED])
@each("formula", CASES)
def test_what_is_still_possible(formula, time):
    assert forecast_of(formula, time=time) == CASES[formula]


@pytest.mark.parametrize("most", [0, 1, 3])
def test_a_search_beyond_its_limit_forecasts_nothing(most, monkeypatch):
    """An incomplete search gives no forecast; complete ones do as before."""
    for name in ("MOST_TRIED", "_MOST_APART"):
        monkeypatch.setattr(f"rvmon.logic.forecast.{name}", most)
    said = {formula: forecast_of(formula) for formula in CASES}
    assert all(one in (None, CASES[formula]) for formula, one in said.items())
    assert (most < 3) is (said != CASES)


@each(("time", "forecast"), [("held", "F"), ("sampled", None), (CLOCKED, "F")])
def test_a_window_without_a_position_requires_nothing(time, forecast):
    """In held time every tick is a position, with a clock some are; samples may skip a window."""
    both = "(always[2 s, 3 s] p) and always[2 s, 3 s] not p"
    assert forecast_of(both, time=time) == forecast


@each("time", ["held", "sampled", "sampled every 3 ns"])
@each(
    "formula",
    [
        "(within 51 ns p) and always[18 ns, 48 ns] not p",
        "(eventually[9 ns, 19 ns] p) and always[19 ns, 48 ns] not p",
        "(eventually[9 ns, 51 ns] p) or always[18 ns, 48 ns] not p",
    ],
)
def test_attempts_of_all_ages_are_forecast_as_each_alone(formula, time):
    if "every" in time:  # bounds are whole periods
        formula = formula.replace("19", "21")
    text = TEXT.format(time, formula).replace("upon start", "upon q")
    instants = range(0, 69, 6)

    def forecasts(*triggers):
        rows = [(t / 1e9, {"p": False, "q": t in triggers}) for t in range(0, 69, 3)]
        found = loads(text).evaluate(rows).attempts
        return {one.triggered: one.forecast for one in found if one.forecast}

    alone = {}
    for t in instants:
        alone |= forecasts(t)
    assert forecasts(*instants) == alone


def test_a_forecast_is_no_verdict():
    spec = loads(TEXT.format("held", "(within 3 s p) and for 5 s not p"))
    report = spec.evaluate([(0, {"p": False, "q": False}), (1, {"q": True})])
    (attempt,) = report.attempts
    assert (attempt.verdict, attempt.forecast) == (Verdict.INCONCLUSIVE, Verdict.FAIL)
    assert '"forecast":"F"' in report.to_json().replace(" ", "")


@each("time", ["held", CLOCKED])
def test_a_network_forecasts_from_known_triggers(time):
    """A trigger in the past restricts continuations; a possible later one does not."""
    formula = "(always (p -> within 5 s q)) and always not q"
    quiet, seen = {"p": False, "q": False}, {"p": True}
    assert forecast_of(formula, quiet, time=time) is None
    assert forecast_of(formula, quiet, seen, time=time) == "F"
    assert forecast_of(f"not ({formula})", quiet, seen, time=time) == "P"


@each("time", ["held", CLOCKED])
def test_a_forecast_below_a_past_operator_is_sound(time):
    """Operators around a past operator may become either; the rest is forecast."""
    back = "(once[0, 2 s] (p and within 9 s q)) and (within 9 s r)"
    samples = {"p": True, "q": False, "r": False}, {"p": True}
    assert forecast_of(back, *samples, time=time) is None
    assert forecast_of(f"{back} and for 9 s not r", *samples, time=time) == "F"
    assert forecast_of(f"not ({back} and for 9 s not r)", *samples, time=time) == "P"


def test_too_many_positions_are_not_forecast():
    """Each nanosecond of a second has an obligation of its own: there is no forecast."""
    formula = "(for 1 s within 3 s p) and eventually[3 s, 5 s] p"
    assert forecast_of(formula, {"p": False, "q": False}, {}) is None


@settings(max_examples=40, deadline=None)
@given(case=cases(Profile(), TraceProfile()))
def test_forecasts_come_true(case):
    if case.spec.max_delay is not None:
        return
    monitor = Spec(case.spec).monitor(sources=case.names)
    seen = {}
    for action in case.actions:
        if isinstance(action, Sample):
            monitor.step_ns(action.t, action.values)
        else:
            monitor.advance_ns(action)
        for attempt in monitor.open:
            if attempt.forecast:
                seen.setdefault((attempt.requirement, attempt.number), attempt.forecast)
    for attempt in monitor.finish_ns(case.end).attempts:
        if attempt.decision is Decision.PREFIX:
            assert seen.get((attempt.requirement, attempt.number), attempt.verdict) == (
                attempt.verdict
            )
