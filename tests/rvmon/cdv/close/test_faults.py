"""Suites that are also chosen by the mutants they kill."""

import importlib.util
from typing import Annotated

import msgspec
import pytest

from rvmon import cdv
from rvmon.cdv.close import Budget, close
from rvmon.cdv.close.faults import with_mutants
from rvmon.cdv.close.outcome import closed_document
from rvmon.cdv.tables import to_json
from rvmon.errors import RvmonError

CODE = """def limited(wanted):
    level = wanted + 1
    if level > 8:
        level = 8
    return level - 1
"""
NESTED = """def limited(wanted):
    return max(min(wanted, 7), min(wanted, 14) - 8)
"""
SPEC = """signal level : int
requirement L1 "It goes no further"
  always (0 <= level and level <= 7)
cover never = level == 100
"""


class Wanted(cdv.Test):
    """The level requested of the machine."""

    wanted: Annotated[int, msgspec.Meta(ge=0, le=20)] = 0


class Machine:
    """Runs the code under test once."""

    def __init__(self, path):
        spec = importlib.util.spec_from_file_location("limited_machine", path)
        self._module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self._module)

    def play(self, test, observer):
        observer(0, {"level": self._module.limited(test.wanted)})
        return cdv.Run(1)


def asked(count, seed):
    """A strategy that requests 0."""
    return [Wanted(name="asked", strategy="asked", seed=1)]


def campaign_of(path, code):
    """A campaign against code that limits a level; its coverage does not depend on the limit."""
    path.write_text(code)
    spec = path.with_name("limited.rv")
    spec.write_text(SPEC)
    return cdv.Campaign(
        name="limited",
        test=Wanted,
        strategies={"asked": asked},
        robots={"machine": cdv.Robot(lambda: Machine(path), spec)},
        code=cdv.Code(cdv.blocks_of(path), branches=False),
    )


@pytest.fixture
def limited(tmp_path):
    return campaign_of(tmp_path / "limited_machine.py", CODE)


@pytest.mark.slow
def test_added_tests_kill_surviving_mutants(limited):
    """Each suite kills at least as much as a smaller one, and held-out mutants count."""
    closed = close(limited, "machine", jobs=1, budget=Budget(tests=40))
    found = with_mutants(limited, "machine", closed, 100, jobs=1)
    trade = found.trade
    one, two, suite, everything = trade.choices
    assert [one.times, two.times, suite.times, everything.times] == [1, 2, None, 0]
    assert one.killed <= two.killed < suite.killed == everything.killed <= trade.mutants
    assert one.held_out <= suite.held_out <= everything.held_out <= trade.held_out
    assert 0 < trade.held_out < trade.mutants
    assert len(closed.suite) < len(found.suite) < len(closed.tests)
    assert {one.job.test.name for one in closed.suite} < {one.job.test.name for one in found.suite}
    assert suite.tests - two.tests == len(found.suite) - len(closed.suite)
    assert b'"trade"' in to_json(closed_document(found))


@pytest.mark.slow
def test_no_more_tests_are_added_than_needed(tmp_path):
    """The limits are missed from 8 and from 16 on: a test of 16 is enough, whatever came first."""
    campaign = campaign_of(tmp_path / "capped.py", NESTED)
    closed = close(campaign, "machine", jobs=1, budget=Budget(tests=40))
    found = with_mutants(campaign, "machine", closed, 100, jobs=1)
    _, two, suite, everything = found.trade.choices
    assert suite.tests - two.tests == 1
    assert two.killed + 3 == suite.killed == everything.killed


@pytest.mark.slow
def test_no_code_no_mutants(limited):
    from dataclasses import replace

    plain = replace(limited, code=None)
    closed = close(plain, "machine", jobs=1, budget=Budget(tests=4))
    with pytest.raises(RvmonError, match="names no code"):
        with_mutants(plain, "machine", closed, 10, jobs=1)
