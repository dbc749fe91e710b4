"""Tests from the model: templates are projected witnesses, and tests stay in their windows."""

import random

import msgspec
import pytest

from handover.driver import run_test
from handover.generator.abstract_test import Action, ReceiveSignal, SendSignal, SetParam
from handover.generator.model_based import (
    ACTIONS,
    PATIENCE,
    PROJECTED,
    instantiate,
    model_based,
    save_templates,
    templates,
)
from handover.model import handover_network
from rvmon.cdv import TestError
from rvmon.cdv.template import Wait, choose_times, load_template, project, save_template
from rvmon.models.search.budget import Policy
from rvmon.models.search.verify import verify


def signals(test):
    return [a.signal for a in test.actions if isinstance(a, SendSignal | ReceiveSignal)]


def postures(test):
    return {a.param: a.value for a in test.actions if isinstance(a, SetParam) and a.param != "time"}


@pytest.mark.slow
def test_one_test_for_each_expressible_requirement():
    """R1 to R4 give a test each; all follow the protocol up to the human's readiness.

    R1's witness has all postures good, R2's at least one bad. The seed decides which.
    """
    tests = model_based(100, seed=3)
    assert [test.name[-2:] for test in tests] == ["R1", "R2", "R3", "R4"]
    for test in tests:
        assert signals(test) == ["activateRobot", "informHumanOfHandoverStart", "humanIsReady"]
    good, bad, *_ = tests
    assert postures(good) == dict.fromkeys(("honTask", "hgazeOk", "hlocationOk", "hpressureOk"), 1)
    assert 0 in postures(bad).values()
    assert tests == model_based(4, seed=3) != model_based(4, seed=6)


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["shortest", "fastest", "likely"])
def test_chosen_times_belong_to_some_run(policy):
    """All choices satisfy every bound of the witness on the projected instants."""
    network = handover_network()
    (query,) = (q for q in network.queries if q.id == "R1")
    run = verify(network, query, policy=Policy(policy)).run
    instants = [0] + [
        number
        for number, step in enumerate(run.steps, start=1)
        for index, _ in step.action.edges
        if network.automata[index].name in PROJECTED
    ]
    limits = run.timing.relation(instants)
    template = templates(policy)[0]
    for seed in range(100):
        times = choose_times(template, random.Random(seed), PATIENCE)
        for first, row in zip(times, limits, strict=True):
            for second, limit in zip(times, row, strict=True):
                assert (second - first) * run.timing.scale <= limit


@pytest.mark.slow
def test_waits_are_chosen_all_over_their_windows():
    template = templates()[0]
    (index,) = (i for i, s in enumerate(template.steps, 1) if s.does == "workflow: ready → tasking")
    seen = set()
    for seed in range(300):
        times = choose_times(template, random.Random(seed), PATIENCE)
        seen.add(times[index] - times[index - 1])
    assert seen == set(range(1, 11))


@pytest.mark.slow
def test_templates_are_files(tmp_path):
    template = templates()[1]
    path = save_template(template, tmp_path)
    assert load_template(path, Action) == template
    assert '"gaze: off → ok"' in path.read_text()


@pytest.mark.slow
def test_each_way_of_choosing_has_its_tests_and_templates(tmp_path):
    tests = {policy: model_based(4, 1, policy) for policy in ("likely", "shortest", "fastest")}
    assert {test.strategy for test in tests["likely"]} == {"model-based"}
    assert {test.strategy for test in tests["fastest"]} == {"model-based-fastest"}
    assert len({test.name for group in tests.values() for test in group}) == 12
    save_templates({"model-based", "model-based-fastest", "constrained"}, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "model-based",
        "model-based-fastest",
    ]
    again = load_template(tmp_path / "model-based-fastest" / "R2.json", Action)
    assert instantiate(again, seed=1) == tests["fastest"][1]


@pytest.mark.slow
def test_a_template_changed_by_hand_is_taken_as_it_is(tmp_path):
    template = templates()[0]
    steps = list(template.steps)
    steps[2] = msgspec.structs.replace(steps[2], wait=Wait(100, 100))
    changed = msgspec.structs.replace(template, steps=tuple(steps))
    times = choose_times(changed, random.Random(1), PATIENCE)
    assert times[3] - times[2] == 100
    steps[4] = msgspec.structs.replace(steps[4], wait=Wait(90, 90))
    with pytest.raises(TestError, match="no times satisfy"):
        instantiate(msgspec.structs.replace(template, steps=tuple(steps)), seed=1)
    (tmp_path / "broken.json").write_text('{"name": 3}')
    with pytest.raises(TestError, match="not a test template"):
        load_template(tmp_path / "broken.json", Action)


@pytest.mark.slow
def test_projection_keeps_only_human_and_sensors():
    network = handover_network()
    run = verify(network, "E<> robot.done and withheld").run
    steps, _ = project(network, run, PROJECTED, ACTIONS)
    assert steps
    assert {step.does.split(":")[0] for step in steps} <= set(PROJECTED)


@pytest.mark.campaign
@pytest.mark.parametrize(("requirement", "event"), [(0, "released"), (1, "withheld")])
def test_the_robot_does_what_the_witness_shows(requirement, event):
    """Played with the robot, R1's test ends with a release, R2's with a refusal."""
    run = run_test(model_based(4, seed=1)[requirement], startup_loss=False)
    assert any(event in values for _, values in run.samples)
