"""A hole has a description, a possible reason, and a way to close it."""

import pytest
from tests.tools.each import each

from rvmon import loads
from rvmon.coverage import Group, Hit, Item, Subject, group_of, merged, model_of
from rvmon.coverage.holes import hole_of, nearest_tests, nearness

SPEC = """
signal level : real
signal calm  : bool
event  go, stop

coverpoint height = level {low: [0, 5), high: [5, inf)}
coverpoint mood {calm: calm, wild: not calm}
cross both = height, mood
requirement R1 "It stops in time"
  upon go
  then within 10 s stop
"""
IDLE = {"t": [0, 1, 20], "level": [1.0, 1.0, 1.0], "calm": [True, True, True]}


@pytest.mark.parametrize(
    ("runs", "goal", "words"),
    [
        ([IDLE], ("height", "high"), "`level >= 5`. No run has shown it; needs a run that shows"),
        (
            [IDLE, {**IDLE, "level": [7.0, 1.0, 1.0]}],
            ("both", "high × wild"),
            "at one instant height high, mood wild. No run has shown mood wild; needs a run "
            "with all of them at once. Nearest: 1.",
        ),
        (
            [IDLE],
            ("R1", "triggered"),
            "R1, “It stops in time”: it is triggered. Its trigger never occurred; needs a run",
        ),
        (
            [IDLE, {**IDLE, "go": [None, True, None], "stop": [None, None, True], "t": [0, 1, 2]}],
            ("R1", "at the deadline"),
            "R1, “It stops in time”: the response comes at the deadline. It was triggered once, "
            "but never like this; needs a response as late as allowed. Nearest: 1.",
        ),
        (
            [IDLE],
            ("`R1` edges", "start → A"),
            "R1, “It stops in time”: step start → A of its automaton, upon: not stop. No "
            "attempt was in start; needs",
        ),
    ],
)
def test_a_hole_in_words(runs, goal, words):
    spec = loads(SPEC)
    model = spec.coverage_model.model
    hits = [(str(number), spec.coverage(run)) for number, run in enumerate(runs)]
    nearest = nearest_tests([goal], hits, model)
    together = merged(found for _, found in hits)
    told = str(hole_of(goal, model, together, nearest.get(goal, "")))
    assert told.startswith(words)


HIT = Hit(1)


def group(name, subject, *items):
    """A group with some items."""
    return group_of(name, subject, [*map(Item, items)])


CROSS = Group(
    "both",
    Subject.CROSS,
    {name: Item(name) for name in ("a × x", "a × y", "b × x", "b × y")},
    axes={"first": ("a", "b"), "second": ("x", "y")},
)
MODEL = model_of(
    [
        CROSS,
        group("transitions", Subject.TRANSITIONS, "A → B", "B → C"),
        group("pairs of transitions", Subject.TRANSITIONS, "A → B → C"),
        group("`R` locations", Subject.STATES, "A"),
        group("`R` edges", Subject.TRANSITIONS, "A → P"),
        group("states", Subject.STATES, "A"),
        group("statements of f", Subject.STATEMENTS, "3", "4", "9"),
        group("branches of f", Subject.BRANCHES, "3 → 4", "3 → 9"),
        group("R", Subject.REQUIREMENT, "triggered", "passed", "`p` decides"),
    ]
)


@each(
    ("goal", "near", "far"),
    [
        (("both", "a × x"), {"both": {"a × y": HIT}}, {"both": {"b × y": HIT}}),
        (("transitions", "B → C"), {"states": {"B": HIT}}, {"states": {"A": HIT}}),
        (
            ("pairs of transitions", "A → B → C"),
            {"transitions": {"A → B": HIT, "B → C": HIT, "B → B": Hit(2)}},
            {"transitions": {"A → B": HIT, "B → C": HIT, "B → B": Hit(9)}},
        ),
        (("`R` edges", "A → P"), {"`R` locations": {"A": HIT}}, {"`R` locations": {"S": HIT}}),
        (
            ("branches of f", "3 → 9"),
            {"statements of f": {"3": HIT}},
            {"statements of f": {"9": HIT}},
        ),
        (
            ("statements of f", "9"),
            {"statements of f": {"4": HIT}},
            {"statements of f": {"3": HIT}},
        ),
        (("R", "passed"), {"R": {"triggered": HIT}}, {}),
    ],
)
def test_what_met_more_of_the_preconditions_is_nearer(goal, near, far):
    assert 1 >= nearness(goal, near, MODEL) > nearness(goal, far, MODEL) >= 0


WAYS = {"A → B": HIT, "B → C": HIT}


@each(
    ("goal", "hits", "why", "needs"),
    [
        (("both", "a × x"), {}, "seen, but at most 0 of 2 at once", "all of them"),
        (("both", "a × x"), {"both": {"a × y": HIT, "b × y": HIT}}, "at most 1 of 2", "all"),
        (("states", "A"), {}, "it was never entered", "a run that enters it"),
        (("transitions", "A → B"), {"states": {"B": HIT}}, "`A` was never entered", "`B` follows"),
        (("pairs of transitions", "A → B → C"), {"states": {"A": HIT}}, "`A` was", "`B` follows"),
        (("pairs of transitions", "A → B → C"), {"transitions": {"A → B": HIT}}, "`B`", "`C`"),
        (("pairs of transitions", "A → B → C"), {"transitions": WAYS}, "both were", "in a row"),
        (("statements of f", "4"), {"statements of f": {"9": HIT}}, "nothing of", "enters `f`"),
        (
            ("statements of f", "9"),
            {"statements of f": {"3": HIT, "4": HIT}},
            "line 4 before it ran, but did not lead there",
            "a run that continues from line 4 to it",
        ),
        (("branches of f", "3 → 9"), {"statements of f": {"4": HIT}}, "3 never ran", "reaches it"),
        (("branches of f", "3 → 9"), {"statements of f": {"3": HIT}}, "3 ran, but", "this one"),
        (("`R` locations", "A"), {}, "no attempt was there", "an attempt gets there"),
        (("`R` edges", "A → P"), {"`R` locations": {"A": HIT}}, "1 attempt was in A", "takes it"),
        (("`R` edges", "A → P"), {"`R` locations": {"A": Hit(2)}}, "2 attempts were", "takes it"),
        (("R", "passed"), {}, "it was never triggered", "triggered and passes"),
        (("R", "`p` decides"), {"R": {"triggered": Hit(2)}}, "triggered 2 times", "without `p`"),
    ],
)
def test_why_it_is_open_and_what_would_close_it(goal, hits, why, needs):
    hole = hole_of(goal, MODEL, hits)
    assert why in hole.why
    assert needs in hole.needs
