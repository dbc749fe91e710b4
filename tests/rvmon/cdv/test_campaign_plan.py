"""The tests that a campaign plays."""

import pytest

from rvmon import cdv
from rvmon.cdv.campaign_plan import plan
from rvmon.errors import RvmonError, UnknownNameError


def test_tests_are_played_on_their_robots(campaign, spec):
    """A test without a robot is played on all, in the order of robots, strategies and tests."""
    robots = {name: cdv.Robot(object, spec) for name in ("a", "b")}
    chosen = plan(campaign(("any", {}), ("for-b", {"robot": "b"}), robots=robots))
    assert [(job.robot, job.test.name) for job in chosen.jobs()] == [
        ("a", "any"),
        ("b", "any"),
        ("b", "for-b"),
    ]


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["twice", "twice"], "two tests are called `twice`"),
        (["twice", "Twice"], "two tests are called `Twice`"),
        (["../../evil"], "use letters, digits"),
        ([".hidden"], "use letters, digits"),
        (["a b"], "use letters, digits"),
    ],
)
def test_names_of_tests_are_unique_file_names(campaign, names, told):
    """Otherwise a test would overwrite another one, or be written anywhere."""
    with pytest.raises(cdv.TestError, match=told):
        plan(campaign(*((name, {}) for name in names)))


def test_an_unknown_strategy_is_told(campaign):
    with pytest.raises(UnknownNameError, match="no strategy `luck`: there are climbs"):
        plan(campaign(("a", {})), ["luck"])


@pytest.mark.parametrize(
    ("made", "told"),
    [
        (lambda *_: 1 / 0, "strategy `s` cannot make its tests: ZeroDivisionError"),
        (lambda *_: ["a"], "strategy `s` makes 'a', which is not a Test"),
        (
            lambda *_: [cdv.Test(name="a", strategy="other", seed=1)],
            "test `a` of strategy `s` names another strategy, `other`",
        ),
        (
            lambda *_: [cdv.Test(name="a", strategy="s", seed=1, text=object())],
            "test `a` cannot be written as JSON",
        ),
        (lambda *_: [cdv.Test(name="a", strategy="s", seed=-1)], "test `a` of `s`: .*>= 0"),
    ],
)
def test_a_strategy_that_fails_is_told(campaign, made, told):
    with pytest.raises(cdv.TestError, match=told):
        plan(campaign(test=cdv.Test, strategies={"s": made}))


def test_what_judges_a_robot_is_read_once(campaign, spec):
    made = campaign(robots={"toy": cdv.Robot(object, spec), "bare": cdv.Robot(object, None)})
    first = made.requirements_of("toy")
    spec.unlink()
    assert made.requirements == {"toy": first}
    assert made.robots["toy"].coverages[0].spec is first.checked
    with pytest.raises(RvmonError, match="name some by --spec"):
        made.requirements_of("bare")
