"""Attempts whose windows generated code follows, beside networks."""

import random

import pytest
from tests.tools.chains import random_chain
from tests.tools.differential import disagreements
from tests.tools.ways import Maker

import rvmon
from rvmon.dataflow import journal
from rvmon.dataflow.network import Network
from rvmon.testing.generate.trace import TraceProfile, random_trace

SETTLE = "always (p -> F[0 s, 5 s] G[0 s, 2 s] q)"


def monitor_of(owed, time="held"):
    spec = rvmon.loads(f"time {time}\nsignal p, q : bool\nrequirement R\n  {owed}\n")
    return spec.monitor(engine="network")


@pytest.fixture
def grown(monkeypatch):
    """The stamps that networks come to."""
    stamps, original = [], Network.grow

    def counted(self, limit, *wanted):
        stamps.append(limit)
        original(self, limit, *wanted)

    monkeypatch.setattr(Network, "grow", counted)
    return stamps


@pytest.mark.law
@pytest.mark.parametrize("form", ["network", "network+interrupt", "network+next"])
@pytest.mark.parametrize("seed", range(3))
def test_the_law_decides(form, seed, monkeypatch):
    """The oracle's records, also where something is lost and where much is let go of."""
    monkeypatch.setattr(journal, "_LEAST", 4)
    rng, make = random.Random(f"windows {seed}"), Maker(form)
    for _ in range(3):
        spec = random_chain(rng)
        for unknowns in (False, True):
            case = random_trace(rng, spec, TraceProfile(unknowns=unknowns, long=50, span=60))
            assert not disagreements(case, make, online=True)


@pytest.mark.parametrize("time", ["held", "sampled"])
def test_no_network_is_needed_where_all_is_known(time, grown):
    """But for the reason of a decision, when somebody reads it."""
    monitor = monitor_of(SETTLE, time)
    found = [one for t in range(200) for one in monitor.step(t, {"p": t % 9 == 0, "q": t % 5 < 2})]
    assert len(found) > 10
    assert not grown
    assert found[0].reason.startswith("`q` became false at 7 s")
    assert grown


@pytest.mark.parametrize("time", ["held", "sampled"])
def test_networks_judge_for_as_long_as_an_unknown_matters(time, grown):
    """What is owed at all times goes on behind a dropout as it did before."""
    monitor = monitor_of("always F[0 s, 5 s] G[0 s, 1 s] q", time)
    for t in range(20):
        assert not monitor.step(t, {"q": t % 4 > 0})
    assert not grown
    assert not monitor.step(20, {"q": None})
    assert not monitor.step(21, {"q": True})
    assert grown
    for t in range(22, 40):
        assert not monitor.step(t, {"q": t % 4 > 0})
    grown.clear()
    found = [one for t in range(40, 60) for one in monitor.step(t, {"q": t < 50})]
    assert [(one.triggered, one.verdict.value) for one in found[:1]] == [(0, "F")]
    assert not grown


@pytest.mark.parametrize("time", ["held", "sampled"])
def test_memory_is_bounded_by_the_windows(time):
    """However long an attempt stays open, as much is kept as changes within their reach."""
    monitor = monitor_of("always F[0 s, 5 s] G[0 s, 1 s] q", time)
    sizes = []
    for k in range(2_000):
        assert not monitor.step(k * 0.5, {"q": k % 4 > 0})
        [judge] = monitor._evaluators.judges
        windows = judge._windows
        kept = [one for one in vars(windows).values() if isinstance(one, list)]
        sizes.append(sum(map(len, kept)) + len(judge._journals[0]))
    assert max(sizes[1_000:]) <= max(sizes[:1_000]) <= 400
