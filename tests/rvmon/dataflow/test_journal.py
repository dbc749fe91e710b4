"""How a network stood a while ago."""

import random

import pytest

import rvmon
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import Network
from rvmon.monitor import compile_spec


def plan_of(requirement, time):
    """The plan of one requirement over two signals."""
    spec = rvmon.loads(
        f"spec s\ntime {time}\nsignal a, b : bool\nrequirement R1\n  {requirement}\n"
    )
    [compiled] = compile_spec(spec.checked).requirements.values()
    return compiled.network_plan


@pytest.mark.parametrize(("time", "gap"), [("held", 1), ("sampled", None)])
@pytest.mark.parametrize("seed", range(5))
def test_it_stood_so(time, gap, seed):
    """After each entry all that was known of it is known again, in whatever order one asks."""
    rng = random.Random(seed)
    plan = plan_of("whenever a then F[2 ns, 5 ns] (b or G[0 ns, 3 ns] a)", time)
    network = Network(plan, gap)
    journal, stood, t = Journal(network), {}, 0
    for _ in range(20):
        t += rng.randint(1, 4)
        if rng.random() < 0.3:
            journal.grow(network, 2 * t)
        else:
            journal.note(network, t, [rng.random() < 0.5 for _ in plan.leaves])
            if rng.random() < 0.5:
                journal.grow(network, 2 * t + 1, 0)
        stood[len(journal)] = network.relative(0), network.grown, list(network.news)
    counts = list(stood)
    rng.shuffle(counts)
    for count in counts:
        found = journal.after(count)
        assert (found.relative(0), found.grown, found.news) == stood[count]


def test_an_interrupted_one_is_over():
    """What was told in part stands in no journal: another one is begun."""
    network = Network(plan_of("whenever a then F[2 ns, 5 ns] b", "held"), 1)
    journal = Journal(network)
    journal.note(network, 0, [True] * len(network.plan.leaves))
    journal.grow(network, 1)
    assert not journal.is_over
    journal.note(network, 3, _Broken())
    with pytest.raises(IndexError):
        journal.grow(network, 7)
    assert journal.is_over


class _Broken:
    """A letter that cannot be read."""

    def __getitem__(self, index):
        raise IndexError
