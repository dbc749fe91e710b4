"""The core against the oracle, on random cases, in all forms in which it runs."""

from dataclasses import replace

import pytest
from tests.tools.differential import campaign
from tests.tools.forms import Compiler, Maker

from rvmon.language.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

pytestmark = pytest.mark.law

LOST = TraceProfile(sparse=10, outages=50)
KINDS = {
    "any": (Profile(crowded=5, wide=10), TraceProfile(sparse=10), {}),
    "outages": (Profile(crowded=5), LOST, {}),
    "amounts": (Profile(amounts=100), LOST, {}),
    "expressions": (Profile(amounts=100, form="expression"), LOST, {}),
    "special": (Profile(), replace(LOST, long=50), {"windows": 90, "letters": 100}),
}
"""Profiles of specifications and traces; per cent of nested windows and of many letters."""


@pytest.mark.parametrize("time", TimeModel)
@pytest.mark.parametrize("kind", KINDS)
def test_each_call_and_the_report_agree_with_the_law(kind, time):
    """By samples, by rows, with a reload in between, and without outages with settle='next' too."""
    profile, traces, special = KINDS[kind]
    is_any = kind == "any"
    forms = ("c", "c rows", "c+next+interrupt") if is_any else ("c rows", "c+interrupt")
    number, each = (12, 6) if is_any else (8, 4)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in forms}
    seeds = [f"{kind}/{time.name}/{seed}" for seed in range(number)]
    profile = replace(profile, time=time)
    found = campaign(makers, seeds, profile, traces, each=each, online_every=4, **special)
    assert not found.disagreements, found.disagreements[0]
    judged = [found.counts[f"judged by {form}"] for form in forms]
    assert judged == [number * each] * len(forms)
    assert is_any or found.counts["pairs with outages"] > number * each / 4
