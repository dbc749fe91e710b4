"""Requirements attached to the bus."""

import pytest

import rvmon
from handover.checker import SPECS, spec_path
from handover.driver import run_test
from handover.generator.abstract_test import directed
from rvmon.cdv.system import Checker

REQUIREMENTS = ("R1", "R2", "R3", "R4", "R5")
TESTS = {test.name: test for test in directed()}


@pytest.fixture(scope="module")
def spec():
    return rvmon.load(spec_path("correct"))


@pytest.mark.parametrize("robot", SPECS)
def test_both_robots_are_judged_by_the_same_requirements(robot):
    texts = {name: one.text for name, one in rvmon.load(spec_path(robot)).requirements.items()}
    assert tuple(texts)[:5] == REQUIREMENTS
    words = rvmon.load(spec_path("correct")).requirements
    assert [texts[name] for name in REQUIREMENTS] == [words[name].text for name in REQUIREMENTS]


@pytest.mark.campaign
def test_judging_online_equals_judging_the_recording(spec):
    checker = Checker(spec)
    late = "mutant-releases-late"
    for name, verdict in ((late, "F"), ("released", "P"), ("withheld-no-gaze", "NT"), (late, "F")):
        checker.start()
        run = run_test(TESTS[name], observer=checker.observe)
        online = checker.finish(run.end_ns)
        names = {*spec.checked.signals, *spec.checked.events}
        monitor = spec.monitor()
        for t_ns, values in run.samples:
            known = {name: value for name, value in values.items() if name in names}
            if known:
                monitor.step_ns(t_ns, known)
        assert online == monitor.finish_ns(run.end_ns)
        assert online.verdicts["R1"] == verdict
