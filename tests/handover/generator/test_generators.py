"""Random tests: their alphabet, their shape, their repeatability."""

import re
from collections import Counter
from pathlib import Path

import pytest

from handover.generator import disturbed as generator
from handover.generator.abstract_test import Action, ReceiveSignal, SendSignal, SetParam, Withdraw
from handover.generator.disturbed import PERSON, disturbed
from handover.generator.pseudorandom import PREFIX, constrained, pseudorandom
from handover.world import parameters as p
from handover.world.faults import SceneFaults, SensorFaults


def test_pseudorandom_actions_are_uniform() -> None:
    """A test has 4 to 15 equally frequent actions; switches are 0 or 1, waits 1 to 100 units."""
    tests = pseudorandom(1000, seed=3)
    assert {len(test.actions) for test in tests} == set(range(4, 16))
    actions = [action for test in tests for action in test.actions]
    kinds = Counter(type(action) for action in actions)
    assert {kind: pytest.approx(1 / 3, abs=0.02) for kind in kinds} == {
        kind: count / len(actions) for kind, count in kinds.items()
    }
    sent = Counter(action.signal for action in actions if isinstance(action, SendSignal))
    assert all(share == pytest.approx(1 / 3, abs=0.03) for share in shares(sent))
    received = Counter(a.signal for a in actions if isinstance(a, ReceiveSignal))
    assert all(share == pytest.approx(1 / 2, abs=0.03) for share in shares(received))
    params = Counter(action.param for action in actions if isinstance(action, SetParam))
    assert len(params) == 11
    assert all(share == pytest.approx(1 / 11, abs=0.02) for share in shares(params))
    values = {(one.param == "time", one.value) for one in actions if isinstance(one, SetParam)}
    assert values <= {*((True, units) for units in range(1, 101)), (False, 0), (False, 1)}


def shares(counts: Counter[str]) -> list[float]:
    return [count / counts.total() for count in counts.values()]


def test_constrained_begin_with_the_protocol() -> None:
    tests = constrained(300, seed=1)
    assert all(test.actions[: len(PREFIX)] == PREFIX for test in tests)
    assert {len(test.actions) - len(PREFIX) for test in tests} == set(range(1, 11))


def test_disturbed_tests_show_each_deviation() -> None:
    """Every fault of sensors and scene occurs, also alone, and every deviation of the person."""
    tests = disturbed(400, seed=1)
    as_planned = [t for t in tests if t.faults == SensorFaults() and t.scene == SceneFaults()]
    assert 0.2 < len(as_planned) / 400 < 0.4
    for name in ("noise_m", "delay_s", "loss", "dropout"):
        assert sum(bool(getattr(test.faults, name)) for test in tests) > 10
    assert sum(test.scene.friction < 0.1 for test in tests) > 10
    assert sum(test.scene.plan_failure > 0 for test in tests) > 10
    assert sum(test.scene.hidden > 0 for test in tests) > 10
    assert {test.scene.far_hand for test in tests if test.scene.beside_m} == {False, True}
    assert {test.postures for test in tests} == {"in_range", "at_limits"}
    ways = Counter(what for test in tests for what in deviations(test.actions))
    assert set(ways) == {"wrong signal", "ready early", "reaches early", "withdraws", "as it is"}
    assert min(ways.values()) > 10


def deviations(actions: tuple[Action, ...]) -> set[str]:
    """The ways in which a person departs from the protocol."""
    inform = ReceiveSignal("informHumanOfHandoverStart")
    before = actions[: actions.index(inform)] if inform in actions else actions
    found = {
        "wrong signal": actions.count(SendSignal("activateRobot")) > 1,
        "ready early": SendSignal("humanIsReady") in before,
        "reaches early": SetParam("hlocationOk", 1) in before,
        "withdraws": Withdraw() in actions,
    }
    return {name for name, is_so in found.items() if is_so} or {"as it is"}


def test_probabilities_of_the_person_add_up() -> None:
    for ways in PERSON.values():
        assert sum(weight for weight, _, _ in ways) == pytest.approx(1)
    assert {state for ways in PERSON.values() for _, _, state in ways} == {*PERSON, "leaves"}


def test_numbers_of_the_person_have_a_source_or_are_listed_as_free() -> None:
    """Each number of a body is in `FREE` or has its source below, and all rates but two."""
    text = Path(p.__file__).read_text("utf-8")
    section = text.partition("# --- human")[2].partition("# --- sensing")[0]
    line = r"([A-Z_]+): Final = .*\n"
    told = re.findall(rf'^{line}(?:{line})?"""[^"]*\((?:paper|ISO)', section, re.MULTILINE)
    sourced = {name for names in told for name in names if name}
    assert sourced | {*p.FREE} == {*re.findall(f"^{line}", section, re.MULTILINE)}
    numbers = {name for name in vars(generator) if name.isupper()} - {"FREE"}
    assert numbers - {*generator.FREE} == {"OK", "NOISE_M"}


@pytest.mark.parametrize("make", [pseudorandom, constrained, disturbed])
def test_tests_depend_on_seed_and_index_alone(make: type) -> None:
    assert make(20, seed=4)[:5] == make(5, seed=4)
    assert make(5, seed=4) != make(5, seed=5)
    tests = make(200, seed=4)
    assert len({test.name for test in tests}) == 200
    assert len({test.seed for test in tests}) == 200
