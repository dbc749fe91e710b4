"""Forecasts of open attempts: what no continuation, or every one, can bring."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rvmon import loads
from rvmon.session import Spec
from rvmon.spec.checked import TimeModel
from rvmon.testing.build import requirement, spec_of, start
from rvmon.testing.generate_ltl import random_ltl
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile
from rvmon.testing.ltl3 import Tableau
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict

HEAD = 'spec t\ntime {}\nsignal p, q : bool\nrequirement R1 "x"\n  upon start then {}\n'
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


@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize("formula", CASES)
def test_what_is_still_possible(formula, time):
    """An open attempt says what it must become, and nothing where it can become either."""
    monitor = loads(HEAD.format(time, formula)).monitor()
    monitor.step_ns(0, {"p": formula.startswith("p until"), "q": False})
    (attempt,) = monitor.open
    assert (attempt.forecast and attempt.forecast.value) == CASES[formula]


@pytest.mark.parametrize(("time", "forecast"), [("held", "F"), ("sampled", None)])
def test_a_window_without_a_position_asks_for_nothing(time, forecast):
    """In held time every tick is a position; samples may leave a window out."""
    both = "(always[2 s, 3 s] p) and always[2 s, 3 s] not p"
    monitor = loads(HEAD.format(time, both)).monitor()
    monitor.step_ns(0, {"p": False, "q": False})
    (attempt,) = monitor.open
    assert (attempt.forecast and attempt.forecast.value) == forecast


def test_a_forecast_is_no_verdict():
    """The report keeps `I`, and the forecast beside it."""
    spec = loads(HEAD.format("held", "(within 3 s p) and for 5 s not p"))
    report = spec.evaluate([(0, {"p": False, "q": False}), (1, {"q": True})])
    (attempt,) = report.attempts
    assert (attempt.verdict, attempt.forecast) == (Verdict.INCONCLUSIVE, Verdict.FAIL)
    assert '"forecast":"F"' in report.to_json().replace(" ", "")


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_untimed_forecasts_are_those_of_the_tableau(data):
    """Verdict or forecast is what the infinite continuations leave, at every position."""

    class Drawn:
        def randint(self, a, b, /):
            return data.draw(st.integers(a, b))

    formula = random_ltl(Drawn(), data.draw(st.integers(1, 3)))
    tableau = Tableau(formula)
    word = data.draw(st.lists(st.frozensets(st.sampled_from("pqr")), min_size=1, max_size=5))
    spec = Spec(spec_of(requirement(formula, upon=start), time=TimeModel.SAMPLED))
    monitor = spec.monitor()
    verdict = None
    for t, letter in enumerate(word):
        for attempt in monitor.step_ns(t, {name: name in letter for name in "pqr"}):
            verdict = attempt.verdict
        said = verdict or monitor.open[0].forecast
        possible = tableau.possible(word[: t + 1])
        wanted = None if len(possible) == 2 else Verdict("P" if True in possible else "F")
        assert said == wanted


@settings(max_examples=80, deadline=None)
@given(case=cases(Profile(mixed=False), TraceProfile()), cut=st.integers(1, 6))
def test_forecasts_come_true(case, cut):
    """What was forecast of an attempt at some moment is never overturned by a later decision."""
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
