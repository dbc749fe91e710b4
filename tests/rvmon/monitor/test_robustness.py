"""Robustness as users ask for it."""

import pytest

import rvmon

HEAD = "spec s\nsignal x : real [cm]\nsignal p : bool\nevent e\nrequirement R1\n  "
INFINITE = float("inf")


def margins(requirement, samples, **options):
    """The figures of a requirement on samples whose times are seconds."""
    return rvmon.loads(HEAD + requirement + "\n").robustness(samples, **options)


def test_a_distance_is_in_base_units():
    """A signal in cm has its robustness in m."""
    found = margins("upon e then within 3 s x > 10 cm", [(0, {"x": 2, "e": True}), (1, {"x": 12})])
    assert found.attempts["R1", 1].low == pytest.approx(0.02)


def test_what_comes_behind_the_decision_counts_as_long_as_the_window_is_open():
    """The best value of the window counts, also if it comes after the first good one."""
    samples = [(0, {"x": 2, "e": True}), (1, {"x": 12}), (2, {"x": 30}), (9, {"x": 99})]
    found = margins("upon e then within 3 s x > 10 cm", samples).attempts["R1", 1]
    assert found.low == found.high == pytest.approx(0.2)


def test_propositions_without_numbers_are_infinite():
    """A bool is as far from false as can be."""
    found = margins("upon e then immediately p", [(0, {"p": True, "e": True})]).attempts["R1", 1]
    assert (found.low, found.high) == (INFINITE, INFINITE)


def test_unknown_input_may_be_anything():
    """A part of the window that is not known leaves an interval."""
    samples = [(0, {"x": 3, "e": True}), (1, {"x": None}), (2, {"x": 5}), (9, {})]
    found = margins("upon e then for 3 s x < 10 cm", samples).attempts["R1", 1]
    assert (found.low, found.high) == (-INFINITE, pytest.approx(0.05))


def test_what_is_held_to_the_end_is_measured_to_the_end():
    """`always` that nothing broke has the least distance of the run."""
    spec = rvmon.loads(HEAD + "always x < 10 cm\n")
    samples = [(0, {"x": 3}), (1, {"x": 8}), (2, {"x": 5})]
    [attempt] = spec.evaluate(samples).attempts
    found = spec.robustness(samples)
    assert found.attempts["R1", 1].low == -INFINITE
    assert found.of(attempt).robustness == pytest.approx(0.02)


def test_a_stream_has_a_figure_per_sample():
    """What is owed is measured at each instant of a sample."""
    samples = [(0, {"x": 3}), (1, {"x": 12}), (2, {"x": 5})]
    stream = margins("always x < 10 cm", samples).streams["R1"]
    assert [(t, found.kept) for t, found in stream] == [
        (0, pytest.approx(-0.02)),
        (10**9, pytest.approx(-0.02)),
        (2 * 10**9, pytest.approx(0.05)),
    ]


def test_an_episode_owes_nothing_where_it_ends():
    """The state that ends an episode is not held against it."""
    samples = [(0, {"p": True, "x": 3}), (1, {"p": False, "x": 99})]
    found = margins("whenever p then immediately x < 10 cm", samples).attempts["R1", 1]
    assert found.low == found.high == pytest.approx(0.07)


def test_until_decides_how_much_is_looked_at():
    """A trace that is cut at its end leaves windows open."""
    samples = [(0, {"x": 3, "e": True})]
    found = margins("upon e then within 3 s x > 10 cm", samples, until=2.0).attempts["R1", 1]
    assert (found.low, found.high) == (pytest.approx(-0.07), INFINITE)
