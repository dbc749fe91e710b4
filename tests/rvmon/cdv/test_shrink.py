"""A failing test becomes the smallest one with the same failure, and a regression test."""

import importlib
import json
import runpy
import sys
import time
from typing import ClassVar

import pytest
from msgspec import structs
from tests.tools.each import each

from rvmon import cdv
from rvmon.cdv.campaign_plan import Job, Outcome
from rvmon.cdv.shrink import Failure, failure_of, regression_test, removed, save_regression, shrink
from rvmon.cdv.test import TestError, load, save, to_json
from rvmon.cli.campaign import main
from rvmon.coverage import Ending
from rvmon.errors import UnknownNameError
from rvmon.verdicts import Verdict


class Steps(cdv.Test):
    """Numbers, and their limit."""

    removable: ClassVar = ("numbers", "words")
    numbers: tuple[int, ...] = ()
    words: tuple[str, ...] = ()

    def simpler(self):
        for at, number in enumerate(self.numbers):
            if number > 0:
                rest = (*self.numbers[:at], number - 1, *self.numbers[at + 1 :])
                yield structs.replace(self, numbers=rest)


def steps(*numbers, **more):
    return Steps(name="a", strategy="s", seed=1, numbers=numbers, **more)


def outcome(*, ending=Ending.COMPLETED, error=None, **verdicts):
    named = {name: Verdict(verdict) for name, verdict in verdicts.items()}
    return Outcome(named, {}, (), {}, ending, error, 0, {}, 0.0)


def fails_if(condition):
    """Plays a test: R1 fails if the condition holds."""
    return lambda test: outcome(R1="F" if condition(test) else "P", R2="F")


@each(
    ("condition", "smallest"),
    [
        (lambda test: 7 in test.numbers, (7,)),
        (lambda test: sum(test.numbers) >= 5, (5,)),
        (lambda test: {2, 8} <= set(test.numbers), (2, 8)),
        (lambda test: len(test.numbers) % 2 == 1, (0,)),
        (bool, ()),
        (lambda test: len(test.numbers) >= 11, (0,) * 11),
        (lambda test: any(b > a + 3 for a, b in zip(test.numbers, test.numbers[1:], strict=False)),
         (0, 4)),
    ],
)  # fmt: skip
def test_no_further_removal_or_simplification_fails_alike(condition, smallest):
    """The requested failure is kept, whatever else fails, and nothing more can be removed.

    No test is played twice.
    """
    seen = []

    def play(test):
        seen.append(to_json(test))
        return fails_if(condition)(test)

    found = shrink(steps(3, 1, 4, 1, 2, 9, 2, 7, 5, 3, 8, words=("b",)), OUTCOME, play)
    assert len(seen) == len(set(seen)) == found.tried
    assert found.is_minimal
    assert (found.test.numbers, found.test.words) == (smallest, ())
    assert found.failure == Failure("R1")
    test = found.test
    fewer = [
        structs.replace(test, numbers=test.numbers[:at] + test.numbers[at + 1 :])
        for at in range(len(test.numbers))
    ]
    assert not any(condition(one) for one in (*fewer, *test.simpler()))


OUTCOME = outcome(R1="F", R2="F")


def test_an_incomplete_run_is_shrunk_to_one_that_ends_alike():
    """Another exception is another failure; a requested requirement takes precedence."""

    def play(test):
        error = "ZeroDivisionError: 1" if 4 in test.numbers else "KeyError: 2"
        return outcome(ending=Ending.CRASHED, error=error, R1="F")

    ended = play(steps(4))
    assert shrink(steps(1, 4, 1), ended, play).test.numbers == (4,)
    assert str(failure_of(ended)) == "the run crashes: ZeroDivisionError"
    assert shrink(steps(1, 4, 1), ended, play, "R1").test.numbers == ()
    assert failure_of(outcome(ending=Ending.HUNG, R1="I")).is_of(outcome(ending=Ending.HUNG))


def test_what_is_not_wrong_is_not_shrunk():
    assert shrink(steps(1), outcome(R1="P", R2="I"), fails_if(bool)) is None
    assert shrink(steps(1), outcome(R1="P", R2="F"), fails_if(bool), "R1") is None
    with pytest.raises(UnknownNameError, match="no requirement `R9`: there are R1, R2"):
        shrink(steps(1), OUTCOME, fails_if(bool), "R9")


def test_the_failure_that_a_test_knows_comes_first():
    both = outcome(R1="F", R2="F")
    found = shrink(steps(1, expected={"R0": "P", "R2": "F"}), both, lambda _: both)
    assert str(found.failure) == "R2 fails"


def test_a_test_that_cannot_be_played_is_no_smaller_one():
    def play(test):
        if len(test.numbers) < 2:
            raise TestError("two at least")
        return OUTCOME

    assert shrink(steps(1, 2, 3), OUTCOME, play).test.numbers == (0, 0)


@pytest.mark.parametrize("ended", [KeyboardInterrupt, None])
def test_a_search_that_is_ended_keeps_what_it_found(ended):
    played = []

    def play(test):
        played.append(test)
        if ended is not None and len(played) == 4:
            raise ended
        return fails_if(lambda one: 9 in one.numbers)(test)

    found = shrink(steps(*range(10)), OUTCOME, play, most=1000 if ended else 3)
    assert not found.is_minimal
    assert 9 in found.test.numbers
    assert len(found.test.numbers) < 10


def test_a_field_that_does_not_exist_is_an_error():
    """It would silently shrink nothing."""

    class Wrong(cdv.Test):
        removable: ClassVar = ("nmubers",)

    with pytest.raises(UnknownNameError, match=r"`Wrong.removable` names `nmubers`"):
        shrink(Wrong(name="a", strategy="s", seed=1), OUTCOME, fails_if(bool))


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ({}, {"R1": "P"}),
        ({"mutation": "m"}, {"R1": "F"}),
        ({"expected": {"R1": "F"}}, {"R1": "F"}),
    ],
)
def test_a_regression_test_has_the_expected_verdicts(campaign, tmp_path, more, expected):
    """Passed once the robot is fixed; failed if it finds a planted fault. It is read back."""
    test = steps(1, 2, **more)
    found = shrink(test, OUTCOME, fails_if(lambda one: 2 in one.numbers))
    made = campaign()
    small = regression_test(made, Job(test, "toy"), found)
    assert (small.name, small.expected, small.mutation) == ("a-small", expected, test.mutation)
    assert removed(test, small) == "1 of 2 numbers, 0 of 0 words"
    path, script = save_regression(made, small, tmp_path)
    assert load(path, Steps) == small
    compile(script.read_text(), script.name, "exec")


@pytest.mark.process
def test_what_ends_its_process_is_shrunk_in_others(campaign, tmp_path, capsys):
    made = campaign(("lost", {"does": "exit"}))
    (test,) = made.strategies["climbs"](1, 1)
    assert main(made, ["shrink", str(save(test, tmp_path))]) == 0
    told = capsys.readouterr()
    assert '"does": "exit"' in told.out
    assert "the run is lost" in told.err


class Stuck:
    """Waits for ever for a missing level, and shows the others."""

    def play(self, test, observer):
        if 4 not in test.numbers:
            time.sleep(3600)
        if 2 not in test.numbers:
            raise cdv.TestError("two is what it begins with")
        for t, number in enumerate(test.numbers):
            observer(t, {"level": number})
        return cdv.Run(len(test.numbers))


@pytest.mark.process
def test_a_smaller_test_that_hangs_is_ended(spec, tmp_path, capsys):
    """It fails differently, like one that cannot be played. The result does neither."""
    made = cdv.Campaign("stuck", Steps, {}, {"stuck": cdv.Robot(Stuck, spec)})
    path = save(steps(2, 6, 4), tmp_path)
    assert main(made, ["shrink", str(path), "--timeout", "2.5"]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out)["numbers"] == [2, 5, 4]
    assert "T1 fails" in told.err


CAMPAIGN = """
import sys
from pathlib import Path
from rvmon import cdv
from rvmon.cli.campaign import main

class Jumps(cdv.Test):
    heights: tuple[float, ...] = ()
    removable = ("heights",)

class Jumper:
    def play(self, test, observer):
        for t, height in enumerate(test.heights):
            observer(t, {"level": height})
        return cdv.Run(len(test.heights))

def jumps(count, seed):
    return [Jumps(name="j", strategy="jumps", seed=1, heights=(1.0, 3.0, 9.0, 2.0))]

robots = {"jumper": cdv.Robot(Jumper, Path(__file__).with_name("toy.rv"))}
campaign = cdv.Campaign("jumps", Jumps, {"jumps": jumps}, robots)
if __name__ == "__main__":
    sys.exit(main(campaign))
"""


@pytest.mark.process
def test_a_campaign_shrinks_what_fails_and_its_page_says_so(spec, tmp_path, monkeypatch, capsys):
    script, out = tmp_path / "jumps.py", tmp_path / "out"
    script.write_text(CAMPAIGN)

    monkeypatch.setattr(sys, "argv", [str(script)])

    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "jumps", module := importlib.import_module("jumps"))

    def run(*words):
        return main(module.campaign, [*map(str, words)])

    assert run("run", "--jobs", 1, "--out", out) == 1
    page = (out / "runs/jumper-j.html").read_text()
    assert f"shrink {out}/tests/j.json</code>" in page
    assert run("shrink", out / "tests/j.json", "--out", out) == 0
    assert "T1 fails: 1 of 4 heights" in capsys.readouterr().err
    small = out / "j-small.json"
    assert b'"heights": [\n    9.0\n  ]' in small.read_bytes()
    assert run("replay", small, "--expected") == 1
    assert "T1 is F, not P" in capsys.readouterr().err
    test = runpy.run_path(str(out / "test_j_small.py"))["test_j_small"]
    with pytest.raises(AssertionError):
        test()
    script.write_text(CAMPAIGN.replace('{"level": height}', '{"level": min(height, 4)}'))
    test()
