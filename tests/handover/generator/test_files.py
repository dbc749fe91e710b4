"""Tests as files: exact, strict, and with messages that say what is wrong."""

import pickle
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tools.each import each

from handover.generator.abstract_test import (
    AbstractTest,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Switch,
    Withdraw,
    directed,
)
from handover.generator.pseudorandom import constrained
from handover.robot.mutants import MUTATIONS
from handover.world.faults import SceneFaults, SensorFaults
from rvmon.cdv import TestError
from rvmon.cdv.test import from_json, load, save, to_json

REQUIREMENTS = ("R1", "R2", "R3", "R4", "R5")
CANNOT_OCCUR = {("R4", "F"), ("R4", "NT")}
"""R4 starts with the run and owes something for ever: it can neither fail nor be untriggered."""


ACTIONS = st.one_of(
    st.builds(SendSignal),
    st.builds(ReceiveSignal),
    st.builds(Withdraw),
    st.builds(SetParam, st.just("time"), st.integers(0, 4000)),
    st.builds(SetParam, st.sampled_from(get_args(Switch)), st.integers(0, 1)),
)
TESTS = st.builds(
    AbstractTest,
    name=st.text(min_size=1, max_size=20),
    seed=st.integers(0, 2**63 - 1),
    actions=st.lists(ACTIONS, max_size=5).map(tuple),
    text=st.text(max_size=20),
    robot=st.sampled_from([None, "correct", "legacy"]),
    horizon_s=st.floats(0.1, 3600),
    faults=st.builds(
        SensorFaults,
        noise_m=st.floats(0, 1),
        delay_s=st.floats(0, 10),
        loss=st.floats(0, 1),
        dropout=st.just(("gaze",)),
    ),
    scene=st.builds(
        SceneFaults,
        st.floats(0.01, 2),
        st.floats(0, 1),
        st.floats(0, 1),
        st.floats(0, 0.1),
        st.booleans(),
    ),
    arrives_s=st.none() | st.floats(0, 60),
)


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(TESTS)
def test_written_tests_read_back(test: AbstractTest) -> None:
    assert from_json(to_json(test), AbstractTest) == test


def test_another_process_writes_the_same_file() -> None:
    for test in (*directed(), *constrained(3, 1)):
        assert to_json(pickle.loads(pickle.dumps(test))) == to_json(test)  # noqa: S301


def test_files_carry_the_name(tmp_path: Path) -> None:
    test = constrained(1, seed=0)[0]
    path = save(test, tmp_path)
    assert path.name == "constrained-000.json"
    assert load(path, AbstractTest) == test


GOOD = to_json(constrained(1, seed=0)[0])


@each(
    ("text", "message"),
    [
        (b"", "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        (GOOD[:100], "not JSON"),
        (b"[]", "Expected `object`"),
        (b"{}", "missing required field `name`"),
        (GOOD.replace(b"activateRobot", b"activate"), r"'activate' - at `\$.actions\[0\].signal`"),
        (GOOD.replace(b'"param"', b'"parameter"', 1), "unknown field `parameter`"),
        (GOOD.replace(b'"time"', b'"hgazeOk"', 1), "`hgazeOk` is 0 or 1, not 40"),
        (GOOD.replace(b"40", b"-1", 1), "Expected `int` >= 0"),
        (GOOD.replace(b'"seed"', b'"horizon_s": -1, "seed"'), "Expected `float` > 0.0"),
    ],
)
def test_wrong_files_are_told(text: bytes, message: str, tmp_path: Path) -> None:
    """Each wrong file gives one message with the file, the place and the cause."""
    path = tmp_path / "wrong.json"
    path.write_bytes(text)
    with pytest.raises(TestError, match=message) as caught:
        load(path, AbstractTest)
    assert "wrong.json" in str(caught.value)


def test_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestError, match=r"none\.json: No such file"):
        load(tmp_path / "none.json", AbstractTest)


def test_directed_tests_cover_every_verdict() -> None:
    tests = directed()
    assert len(tests) >= 10
    assert all(test.text and test.robot and not test.startup_loss for test in tests)
    assert all(set(test.expected) >= set(REQUIREMENTS) for test in tests)
    assert {test.mutation for test in tests} - {None} == set(MUTATIONS)
    covered = {
        (requirement, verdict)
        for test in tests
        if test.robot == "correct"
        for requirement, verdict in test.expected.items()
        if requirement in REQUIREMENTS
    }
    everything = {(r, v) for r in REQUIREMENTS for v in ("P", "F", "NT", "I")}
    assert covered == everything - CANNOT_OCCUR
