"""The correct robot conforms to the model; robots with faults do not."""

from dataclasses import replace

import pytest

from handover.checker.conformance import check_run
from handover.driver import run_test
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.model import handover_network


@pytest.fixture(scope="module")
def network():
    return handover_network()


@pytest.fixture(scope="module")
def of_the_model():
    """The tests from the model, which is searched once."""
    return model_based(4, seed=1)


@pytest.mark.campaign
def test_runs_of_the_correct_robot_conform(network, of_the_model):
    """Of tests from the model, and others."""
    for test in [*pseudorandom(2, seed=1), *constrained(1, seed=1), *of_the_model[:2]]:
        assert check_run(network, run_test(test)).conforms is True, test.name


@pytest.mark.campaign
@pytest.mark.parametrize(("moved_s", "conforms"), [(0.0, True), (None, False), (1.0, False)])
def test_the_robot_goes_by_the_readiness_of_the_human(network, of_the_model, moved_s, conforms):
    run = run_test(of_the_model[1])
    samples = []
    for t_ns, values in run.samples:
        if "humanIsReady" in values:
            values = {name: value for name, value in values.items() if name != "humanIsReady"}
            if moved_s is not None:
                samples.append((t_ns + round(moved_s * 1e9), {"humanIsReady": True}))
        samples.append((t_ns, values))
    assert check_run(network, replace(run, samples=tuple(samples))).conforms is conforms


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("mutation", "witness"),
    [("forgets-to-release", 0), ("releases-late", 0), ("ignores-pressure", 1),
     ("ends-silently", 0)],
)  # fmt: skip
def test_faults_are_divergences(network, of_the_model, mutation, witness):
    run = run_test(of_the_model[witness], mutation=mutation, startup_loss=False)
    assert check_run(network, run).conforms is False
