"""Test files are exact, validated strictly, and refused with precise messages."""

import pickle
from pathlib import Path

import pytest
from tests.tools.each import each

from handover.generator.abstract_test import AbstractTest, directed
from handover.generator.disturbed import disturbed
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.robot.mutants import MUTATIONS
from rvmon.cdv import TestError
from rvmon.cdv.test import from_json, load, save, to_json

REQUIREMENTS = ("R1", "R2", "R3", "R4", "R5")
CANNOT_OCCUR = {("R4", "F"), ("R4", "NT")}
"""R4 starts with the run and owes something for ever: it can neither fail nor be untriggered."""


def test_another_process_writes_the_same_file_and_reads_it_back() -> None:
    generated = (*pseudorandom(20, 1), *constrained(20, 1), *disturbed(200, 1))
    for test in (*directed(), *generated):
        written = to_json(pickle.loads(pickle.dumps(test)))  # noqa: S301
        assert to_json(test) == written
        assert from_json(written, AbstractTest) == test


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
        (None, "No such file"),
    ],
)
def test_invalid_files_are_refused(text: bytes | None, message: str, tmp_path: Path) -> None:
    """Each gives one message with the file, the place and the cause."""
    path = tmp_path / "wrong.json"
    path.unlink(missing_ok=True)
    if text is not None:
        path.write_bytes(text)
    with pytest.raises(TestError, match=message) as caught:
        load(path, AbstractTest)
    assert "wrong.json" in str(caught.value)


def test_files_carry_the_name(tmp_path: Path) -> None:
    path = save(constrained(1, seed=0)[0], tmp_path)
    assert (path.name, path.read_bytes()) == ("constrained-000.json", GOOD)


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
