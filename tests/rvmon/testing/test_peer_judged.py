"""Peers asked about recordings: what is sent to them, and what their answer is held against."""

import pytest
from tests.tools.build import always, e, eventually, p, q, requirement, rise, spec_of, timeline

from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.case import Case
from rvmon.testing.cross import crossings
from rvmon.testing.oracle import evaluate
from rvmon.testing.peers.judged import Unfit, disagreements
from rvmon.testing.peers.ways import WAYS

SECOND = 10**9


class Parrot:
    """A peer that remembers what it was asked and answers as told."""

    def __init__(self, values):
        self.values = values
        self.asked = {}

    def ask(self, do, **request):
        assert do == "judge"
        self.asked = request
        return {"values": self.values}


def case_of(owed, samples, **more):
    return Case(spec_of(requirement(owed, upon=rise(p), **more)), samples, samples[-1].t)


def slow(samples):
    return tuple(type(sample)(sample.t * SECOND, sample.values) for sample in samples)


def test_bounds_and_columns_are_in_the_coarsest_tick():
    """A recording at whole seconds is one of few ticks to a peer."""
    case = case_of(eventually(q, 0, 2 * SECOND), slow(timeline(p="010000", q="000100")))
    report = evaluate_by_engine(case)
    peer = Parrot([1.0] * 6)
    assert disagreements(WAYS["rtamt-dense"], peer, case, report) == []
    assert "[0:2]" in peer.asked["formula"]
    assert peer.asked["columns"]["v_q"] == [0, 0, 0, 1, 0, 0]


def test_a_peer_that_says_otherwise_disagrees():
    """The attempt and its trigger are named."""
    case = case_of(eventually(q, 0, 2 * SECOND), slow(timeline(p="010000", q="000100")))
    report = evaluate_by_engine(case)
    [line] = disagreements(WAYS["rtamt-dense"], Parrot([-1.0] * 6), case, report)
    assert line == "R #1: triggered at 1 s, P; the peer says false"


def evaluate_by_engine(case):
    from rvmon.session import Spec
    from rvmon.testing.drive import drive

    return drive(Spec(case.spec).monitor(), case)[0]


UNFIT = {
    "an event in held time": (always(e), timeline(p="01", e="01", q="00"), "event"),
    "an unknown value": (eventually(q, 0, 2), timeline(p="01", q=".1"), "`q` is unknown at 0 s"),
}


@pytest.mark.parametrize("name", UNFIT)
def test_what_peers_cannot_be_asked(name):
    """The reason is said."""
    owed, samples, message = UNFIT[name]
    case = case_of(owed, samples)
    with pytest.raises(Unfit, match=message):
        disagreements(WAYS["rtamt-dense"], Parrot([]), case, evaluate_by_engine(case))


def test_positions_have_to_be_evenly_spaced():
    """A peer of discrete time has a position at every tick."""
    spec = spec_of(requirement(eventually(q, 0, 2), upon=rise(p)), time=TimeModel.SAMPLED)
    samples = (*timeline(p="01", q="00"), *timeline(p=".....1", q=".....1"))
    case = Case(spec, samples, 5)
    with pytest.raises(Unfit, match="evenly spaced"):
        disagreements(WAYS["rtamt-discrete"], Parrot([]), case, evaluate_by_engine(case))


@pytest.mark.slow
def test_peers_stand_in_the_table_of_their_time_model():
    """Ways that read time otherwise are left out."""
    case = case_of(eventually(q, 0, 2), timeline(p="0100", q="0001"))
    [crossing] = crossings(case, {"rtamt": Parrot([1.0] * 4)})
    assert "rtamt-dense" in crossing.answers
    assert "rtamt-discrete" not in crossing.answers
    assert crossing.agrees
    assert crossing.report.verdicts == evaluate(case.spec, case.samples, end=3).verdicts
