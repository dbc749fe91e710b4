"""Closing the holes of small campaigns."""

import os
from dataclasses import replace
from typing import Annotated, Literal

import msgspec
import pytest

from rvmon import cdv
from rvmon.cdv.campaign import Closing, ClosingModel, Unreachable, unreachable_items
from rvmon.cdv.close import Budget, close
from rvmon.cdv.close.goals import EDGES
from rvmon.cdv.close.outcome import print_closed
from rvmon.cdv.coverage import coverage_model
from rvmon.cdv.test import TestError
from rvmon.coverage import Ending
from rvmon.errors import ModelError, UnknownNameError
from rvmon.models.language.load import loads_network
from rvmon.report.printer import Printer

pytestmark = pytest.mark.slow

SPEC = """
spec dials "Two dials"
signal left, right : int
coverpoint of_left = left {zero: 0, one: 1, two: 2}
coverpoint of_right = right {zero: 0, one: 1, two: 2}
cross both = of_left, of_right
"""

MODEL = """
network dials
unit 1 s
int[0,3] left, right
automaton person {
  location choosing
  location left_is_up
  location done
  start choosing
  edge choosing -> left_is_up do left = 2
  edge left_is_up -> done do right = 2
  edge choosing -> done
}
automaton machine {
  location off
  location on
  start off
  edge off -> on when left == 2
}
"""

Turn = Annotated[int, msgspec.Meta(ge=0, le=2)]


class Dials(cdv.Test):
    """Both dials are turned."""

    left: Turn = 0
    right: Turn = 0
    does: Literal["", "kill", "crash"] = ""


class Machine:
    """Shows the values of its dials."""

    def play(self, test, observer):
        if test.does == "kill":
            os.kill(os.getpid(), 9)
        if test.does == "crash":
            raise ZeroDivisionError
        observer(0, {"left": test.left, "right": test.right})
        states = [(0, "off"), (1, "on")] if test.left == 2 else [(0, "off")]
        return cdv.Run(1, states=states)


def still(count, seed):
    """A strategy that never turns a dial."""
    return [Dials(name="still", strategy="still", seed=1)]


@pytest.fixture
def dials(tmp_path):
    """Makes a campaign with options for closing its holes."""
    path = tmp_path / "dials.rv"
    path.write_text(SPEC)

    def made(**closing):
        closing = {"fixed": ("does",), **closing}
        return cdv.Campaign(
            name="dials",
            test=Dials,
            strategies={"still": still},
            robots={"machine": cdv.Robot(Machine, path)},
            closing=Closing(**closing),
        )

    return made


def test_tests_are_changed_until_all_is_covered(dials):
    closed = close(dials(), "machine", jobs=1, margin=1)
    assert (closed.open, closed.ended, closed.met) == ({}, "", 15)
    assert len(closed.suite) == closed.needed == closed.fewest == 9
    assert sum(len(one.goals) for one in closed.tests) == closed.met == closed.tests[-1].met


def test_the_suite_keeps_a_margin(dials):
    """Each goal is hit by two tests if two were found; the size without a margin is reported."""
    closed = close(dials(), "machine", jobs=1, margin=2)
    assert [*closed.sizes] == [1, 2]
    assert closed.sizes[1] == 9 < closed.sizes[2] == closed.needed == len(closed.suite)

    def shown(tests, goal):
        hits = (one.outcome.hits.get(goal[0], {}) for one in tests)
        return sum(goal[1] in items for items in hits)

    played = [one.played for one in closed.tests]
    goals = {goal for one in closed.tests for goal in one.goals}
    assert {min(2, shown(played, goal)) for goal in goals} == {1, 2}
    for goal in goals:
        assert shown(closed.suite, goal) >= min(2, shown(played, goal))


def test_the_seed_decides_whatever_the_number_of_processes(dials):
    one, two = (close(dials(), "machine", jobs=jobs, seed=3) for jobs in (1, 2))
    other = close(dials(), "machine", jobs=1, seed=4)
    did = [[(test.played.job.test, test.goals) for test in run.tests] for run in (one, two, other)]
    assert did[0] == did[1] != did[2]


def test_at_the_end_of_the_budget_a_line_to_declare_the_rest_unreachable_is_printed(dials, capsys):
    """The printed line, completed with a reason, can be used as it is."""
    closed = close(dials(), "machine", jobs=1, budget=Budget(tests=3))
    assert len(closed.tests) == 3
    assert closed.ended == "after 3 tests"
    assert len(closed.open) == closed.goals - closed.met > 0
    print_closed(closed, Printer(width=100))
    told = capsys.readouterr().out
    (line,) = (one for one in told.splitlines() if "cdv.Unreachable" in one)
    assert eval(line) == cdv.Unreachable(*next(iter(closed.open)), "…")  # noqa: S307 - our own line
    closed = close(dials(), "machine", jobs=1, budget=Budget(seconds=0.0))
    assert closed.ended == "after 0 s"


def test_tests_that_end_their_process_do_not_end_the_search(dials):
    closed = close(dials(fixed=()), "machine", jobs=1, margin=1, budget=Budget(tests=400))
    assert closed.open == {}
    endings = [one.outcome.ending for one in closed.suite]
    assert {ending: endings.count(ending) for ending in endings} == {
        Ending.COMPLETED: 9,
        Ending.CRASHED: 1,
        Ending.LOST: 1,
    }
    assert closed.needed == 9


def test_unreachable_items_are_not_goals_and_must_not_be_hit(dials):
    """A test that hits one is an error, which names the test."""
    out = Unreachable("both", "two × two", "the dials touch each other")
    closed = close(dials(unreachable=[out]), "machine", jobs=1)
    assert closed.goals == 14
    assert closed.argued == {("both", "two × two"): "the dials touch each other"}
    assert ("both", "two × two") not in [goal for one in closed.tests for goal in one.goals]
    out = Unreachable("of_left", "zero", "it never is")
    closed = close(dials(unreachable=[out]), "machine", jobs=1)
    assert closed.wrong == {("of_left", "zero"): "closed-001"}


def test_unknown_items_are_refused(dials):
    for place, fix in (
        (("both", "two × seven"), "did you mean `both: "),
        (("of_rigth", "two"), "did you mean `of_right: two`?"),
        (("", "return 1"), "take it out"),
    ):
        with pytest.raises(UnknownNameError, match="declares unreachable an item") as caught:
            close(dials(unreachable=[Unreachable(*place, "so")]), "machine", jobs=1)
        assert fix in str(caught.value)


def test_lines_are_named_by_their_text(dials, code):
    """A line is its statement and the branches to it; a block or a single branch can be named."""
    campaign = replace(dials(), code=cdv.Code(cdv.blocks_of(code)))
    unreachable = [
        Unreachable("", "return self.high()", "too high"),
        Unreachable("statements of Toy.high", "return 6", "too high"),
        Unreachable("", "if to > 4: → return to", "all do"),
    ]
    campaign = replace(campaign, closing=Closing(unreachable=unreachable))
    closed = close(campaign, "machine", jobs=1, budget=Budget(tests=1))
    assert set(closed.argued) == {
        ("statements of Toy.climb", "5"),
        ("branches of Toy.climb", "4 → 5"),
        ("statements of Toy.high", "9"),
        ("branches of Toy.climb", "4 → 6"),
    }


def model(query=lambda *_: "", **more):
    """The model of the dials, with tests from its runs."""

    def make(template, seed):
        did = {step.action for step in template.steps}
        turned = {"left": 2} if "left" in did else {}
        turned |= {"right": 2} if "right" in did else {}
        return Dials(name="x", strategy="x", seed=seed, **turned)

    return ClosingModel(
        **{
            "network": lambda: loads_network(MODEL),
            "automata": ("person",),
            "actions": {
                ("person", "choosing", "left_is_up"): "left",
                ("person", "left_is_up", "done"): "right",
            },
            "make": make,
            "query": query,
            "automaton": "machine",
            "states": {"off": "off", "on": "on"},
            **more,
        }
    )


def test_runs_of_the_model_become_tests_and_its_answers_proofs(dials):
    def query(group, item):
        if group == "both":
            left, right = map(("zero", "one", "two").index, item.split(" × "))
            return f"E<> left == {left} and right == {right} and person.done"
        return ""

    closed = close(dials(model=model(query)), "machine", jobs=1, budget=Budget(tests=8))
    first = closed.tests[0]
    assert (
        first.origin == "a run of the model that shows E<> left == 0 and right == 0 and person.done"
    )
    assert ("both", "two × two") not in [*closed.open, *closed.proved]
    assert closed.proved["both", "one × two"] == "E<> left == 1 and right == 2 and person.done"
    edges = {name for group, name in closed.tests[1].goals if group == EDGES}
    assert edges == {"person: choosing → left_is_up", "person: left_is_up → done"}
    assert ("edges of the model", "machine: off → on") not in closed.open


@pytest.mark.parametrize(("query", "closed_by"), [("E<> left == 3", "proved"), ("", "open")])
def test_an_unproved_item_is_open(dials, query, closed_by):
    """Playing a campaign assumes the proof; `close` demands it."""
    goal = ("both", "one × two")
    campaign = dials(model=model(lambda *names: query if names == goal else ""))
    given = Unreachable(*goal, "the model proves it", by_model=True)
    campaign = replace(campaign, closing=replace(campaign.closing, unreachable=[given]))
    assert goal in unreachable_items(campaign, "machine", coverage_model(campaign, "machine"))
    closed = close(campaign, "machine", jobs=1, budget=Budget(tests=1))
    assert (goal in closed.proved, goal in closed.open) == (
        closed_by == "proved",
        closed_by == "open",
    )
    assert closed.argued == {}


def test_edges_are_shown_only_by_tests_that_go_their_way(dials):
    campaign = dials(model=model(states={"off": "on", "on": "off"}))
    closed = close(campaign, "machine", jobs=1, budget=Budget(tests=12))
    hole = closed.open[EDGES, "machine: off → on"]
    assert hole.why.endswith("where the run enters `on`")
    assert hole.nearest in {one.played.job.test.name for one in closed.tests}


@pytest.mark.parametrize(
    ("edge", "wrong"),
    [
        (("person", "choosing", "gone"), "no edge"),
        (("person", "choosing", "done", "aloud"), "no edge"),
        (("person", "choosing", "done"), "several edges .* name each: .*''.*, 'quit'"),
    ],
)
def test_actions_of_tests_are_assigned_to_edges(dials, edge, wrong):
    """Edges between the same locations are named by label or channel; unknown names are errors."""
    text = MODEL.replace("choosing -> done", "choosing -> done\n  edge choosing -> done as quit")

    def tests(actions):
        network = model(network=lambda: loads_network(text), actions=actions)
        return close(dials(model=network), "machine", jobs=1, budget=Budget(tests=8)).tests

    with pytest.raises(TestError, match=wrong):
        tests({edge: "left"})
    quits = tests({("person", "choosing", "done", "quit"): "left"})
    turned = {one.origin: one.played.job.test.left for one in quits}
    assert turned["a run of the model that shows the edge person: choosing → done (2)"] == 2
    assert turned["a run of the model that shows the edge person: choosing → done"] == 0


def test_a_model_proves_nothing_of_robots_that_it_does_not_describe(dials):
    impossible = model(lambda *_: "E<> left == 3", robots=("another",))
    closed = close(dials(model=impossible), "machine", jobs=1)
    assert (closed.proved, closed.open, closed.groups) == ({}, {}, [])


def test_choices_are_biased_towards_what_is_open(dials):
    def biased(choose, seed):
        left, right = choose("left", (0, 1, 2)), choose("right", (0, 1, 2))
        return Dials(name="x", strategy="x", seed=seed, left=left, right=right)

    campaign = dials(biased=biased, fixed=("left", "right", "does"))
    closed = close(campaign, "machine", jobs=1)
    assert closed.open == {}
    assert any(one.origin.startswith("choices biased towards") for one in closed.tests)


def test_written_tests_come_first(dials):
    def written(count, seed):
        return [Dials(name=f"w{n}", strategy="written", seed=1, left=n) for n in (2, 1)]

    campaign = dials(written=("written",))
    campaign = replace(campaign, strategies={**campaign.strategies, "written": written})
    closed = close(campaign, "machine", strategies=("still",), jobs=1)
    origins = [one.origin for one in closed.tests]
    assert origins[:2] == ["w2 of written", "w1 of written"]
    assert not any(origin.endswith("of written") for origin in origins[2:])


def test_nonsense_of_a_campaign_is_told(dials):
    def failing(choose, seed):
        raise KeyError("x")

    for biased, told in ((failing, "cannot make a test: KeyError"), (lambda *_: 3, "makes 3")):
        with pytest.raises(TestError, match=told):
            close(replace(dials(biased=biased), strategies={}), "machine", jobs=1)
    with pytest.raises(ModelError, match="no name `nothing`"):
        close(dials(model=model(lambda *_: "E<> nothing")), "machine", jobs=1)


def test_a_test_type_without_room_for_closing_is_refused(dials):
    """Generated tests record that they close holes, so their type needs the field."""

    class Strict(cdv.Test):
        strategy: Literal["still"]

    def strict(count, seed):
        return [Strict(name="still", strategy="still", seed=1)]

    campaign = replace(dials(), test=Strict, strategies={"still": strict})
    with pytest.raises(TestError, match="does `Strict` take the strategy `closed`"):
        close(campaign, "machine", jobs=1)


def test_a_campaign_that_can_make_no_test_ends(dials):
    closed = close(replace(dials(), strategies={}), "machine", jobs=1)
    assert closed.ended == "no further test can be made"
    assert closed.tests == []
