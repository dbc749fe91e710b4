"""Mutants are killed, with the reason, or survive, and leave nothing behind."""

import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from tests.rvmon.cdv.conftest import needs_fork
from tests.rvmon.cdv.mutation.conftest import System, lift_of, rides

from rvmon import cdv
from rvmon.cdv.mutation import play
from rvmon.cdv.mutation.baseline import record_suite
from rvmon.cdv.mutation.play import plant
from rvmon.cdv.mutation.python_mutants import HELD_OUT, code_mutants
from rvmon.cdv.mutation.spec_mutants import spec_mutants, try_spec_mutants
from rvmon.cdv.mutation.survivors import How, Missing, failing_runs, missing, scored
from rvmon.errors import RvmonError
from rvmon.execute import parallel
from rvmon.session import load

pytestmark = [pytest.mark.process, needs_fork]


DOOR = 'told.append(("door", True))'
TOLD = 'told.append(("floor", floor))'


def test_a_failed_requirement_kills_and_ends_the_play_unless_all_tests_are_requested(
    tried, changed
):
    """A requirement that fails without the mutant does not kill it."""
    mutant = changed("Lift.ride", DOOR, "pass")
    (one,) = tried([mutant], tests=3)
    assert one.killed_by_requirement
    assert (one.reaching, one.played) == (3, 1)
    assert [(found.test, found.how, found.what) for found in one.findings] == [
        ("second", How.REQUIREMENT, ("L1",))
    ]
    (one,) = tried([mutant], tests=3, every=True)
    assert [found.test for found in one.findings] == ["second", "third"]


def test_a_known_answer_kills_where_no_requirement_fails(tried, changed):
    (one,) = tried([changed("Lift.ride", "return told", "return told[:-1] and told[:0]")])
    assert [found.how for found in one.findings] == [How.ANSWER]
    assert one.killed
    assert not one.killed_by_requirement


@pytest.mark.parametrize(
    ("line", "how"),
    [
        ("self.nothing", How.CRASHED),
        ("while True: pass", How.HUNG),
        ("eaten = [0] * 10**10", How.HUNG),
        ("import os; os._exit(3)", How.LOST),
        ("import os; os.kill(os.getpid(), 9)", How.LOST),
    ],
)
def test_misbehaviour_of_mutants_is_a_result(tried, changed, line, how):
    """A mutant that raises, loops, exhausts memory or exits harms nothing else."""
    fine = changed("Lift.ride", DOOR, "pass")
    one, other = tried([changed("Lift.ride", "self.note(to)", line), fine])
    assert [found.how for found in one.findings] == [how]
    assert other.killed_by_requirement


def test_long_waits_are_not_hangs(campaign, changed, monkeypatch):
    """As with a simulator or on a busy machine: tests may wait as long as they need."""

    class Waits(System):
        def play(self, test, observer):
            time.sleep(2.0)
            return super().play(test, observer)

    monkeypatch.setattr(play, "PATIENCE_S", 1.0)
    path = Path(next(iter(campaign.code.constants)))
    robot = cdv.Robot(lambda: Waits(path), campaign.robots["lift"].spec)
    suite = record_suite(replace(campaign, robots={"lift": robot}), "lift", rides(1, 1), jobs=1)
    mutant = changed("Lift.note", "self.noted = to", "self.noted = 0")
    (one,) = play.play_mutants(suite, [mutant], jobs=1)
    assert one.findings == ()


def test_a_mutant_that_no_test_runs_is_not_played(tried, changed):
    mutant = changed("Lift.ride", 'told.append(("refused", True))', "pass")
    (unreached,) = tried([mutant])
    assert missing(unreached) is Missing.STIMULUS
    assert unreached.played == 0
    (differs,) = tried([mutant], tests=3)
    assert missing(differs) is Missing.REQUIREMENT
    found = differs.difference
    assert (found.test, found.t_ns, found.name) == ("beyond", 3 * 10**9, "refused")


def test_what_is_not_recorded_asks_for_an_observation_and_the_code_as_it_is_differs_nowhere(
    tried, changed
):
    unseen = changed("Lift.note", "self.noted = to", "self.noted = 0")
    one, same = tried([unseen, changed("Lift.ride", DOOR, f"{DOOR}  # as it is")])
    assert missing(one) is Missing.OBSERVATION
    assert not same.killed
    assert same.difference is None


def test_a_constant_is_changed_with_what_is_made_of_it(tried, changed):
    top, floors = tried(
        [changed("TOP", "TOP = 3", "TOP = 1"), changed("FLOORS", "range(TOP)", "range(1)")]
    )
    assert top.difference.name == "floor"
    assert floors.difference.name == "floor"


def test_mutants_that_cannot_be_planted_do_not_count(tried, changed):
    """The code of a function cannot be replaced if the closure differs."""
    (one,) = tried([changed("Lift.note", "self.noted = to", "super().__init__()")])
    assert "cannot be changed" in one.invalid
    assert scored([one]).mutants == 0


def ride_later(source):
    """Plants the mutant and only then loads the lift."""

    def ride(mutant):
        plant(mutant, source)
        return lift_of(mutant.path).Lift().ride(1)

    return ride


def test_a_module_loaded_later_has_the_mutant(changed):
    """As in a system that imports its code when it plays."""
    mutant = changed("Lift.ride", DOOR, "pass")
    source = mutant.path.read_text()
    (told,) = parallel.execute(
        [mutant], partial(ride_later, source), jobs=1, instead=lambda *_: None, fresh=True
    )
    assert told == [("floor", 1)]


def test_runs_of_faulty_code_judge_requirements(campaign, tried, changed):
    """They distinguish bounds that the unchanged code never comes near; none is held out."""
    mutants = [
        replace(changed("Lift.ride", TOLD, f"{TOLD}; {TOLD}"), ordinal=number)
        for number in range(9)
    ]
    found = tried(mutants, keep=True)
    runs = failing_runs(found)
    assert {*runs} == {f"second with {one.identity}" for one in mutants if one.third != HELD_OUT}
    assert 0 < len(runs) < len(mutants)
    spec = load(campaign.robots["lift"].spec)
    judged = try_spec_mutants(spec, spec_mutants(spec.checked), runs)
    later = next(one for one in judged if one.mutant.after == "upon start then within 4 s door")
    assert (later.test, later.was, later.now) == (next(iter(runs)), "F", "P")


def test_results_do_not_depend_on_processes(campaign, tried):
    mutants = code_mutants(campaign.code)[::8]
    found = tried(mutants, jobs=2, tests=2)
    assert found == tried(mutants, jobs=1, tests=2)
    alive = [one.mutant.identity for one in found if not one.killed]
    score = scored(found, alive[:1])
    assert (score.mutants, score.killed) == (len(found), len(found) - len(alive))
    assert score.rest == len(found) - 1
    assert 0 < score.by_requirement <= score.killed


def test_a_suite_that_says_nothing_is_refused(campaign):
    with pytest.raises(RvmonError, match="no test for this robot"):
        record_suite(campaign, "lift", [], jobs=1)
