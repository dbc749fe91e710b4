"""Cases in which an engine once differed from the law, shrunk by the differential test."""

import pytest

import rvmon
from rvmon.testing import oracle
from rvmon.testing.compare import differences
from rvmon.trace.sample import Sample

CASES = {
    "a row met younger later leads on younger": (
        "held",
        "upon start\n  then (always p) R (e R[3 ns, 5 ns] true)",
        [(0, {})],
        5,
    ),
    "a signal that nothing reads grows stale between two ticks": (
        "sampled every 3 ns",
        "upon e\n  then true",
        [(8, {}), (13, {"unread": 1.0}), (16, {"e": True})],
        16,
    ),
    "an instance begins between two ticks of the clock": (
        "sampled every 3 ns",
        "upon g\n  then start\n  for each v in g.k",
        [(1, {}), (10, {"g": ({"k": 1}, {"k": 0})})],
        12,
    ),
}


@pytest.mark.parametrize("engine", ["auto", "automaton", "progression"])
@pytest.mark.parametrize("name", CASES)
def test_engines_agree_with_the_law(name, engine):
    """Each engine gives the oracle's verdicts and decision instants."""
    time, requirement, samples, end = CASES[name]
    spec = rvmon.loads(
        f"spec s\ntime {time}\nsignal p, q : bool\nsignal unread : real stale after 1 ns\n"
        f"event e\nevent g(k: int)\n"
        f"requirement R1\n  {requirement}\n"
    )
    monitor = spec.monitor(engine=engine)
    for t, values in samples:
        monitor.step_ns(t, values)
    law = oracle.evaluate(spec, [Sample(t, values) for t, values in samples], end=end)
    assert not differences(law, monitor.finish_ns(end))


def test_what_cannot_be_judged_within_bounds_says_so():
    """A window above 0 that is started at every tick ends in a message, not in a hang."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nevent b\nrequirement R1\n  always (a -> F[2 s, 5 s] b)\n"
    )
    monitor = spec.monitor()
    monitor.step(0, {"a": True})
    with pytest.raises(rvmon.RvmonError, match="an attempt of R1 owes more than 256 obligations"):
        monitor.step(1, {"a": False})
