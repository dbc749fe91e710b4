"""How near tests came to what they did not hit."""

import pytest

from rvmon.coverage import Group, Hit, Item, Subject, group_of, model_of
from rvmon.coverage.holes import nearness

HIT = Hit(1)


def group(name, subject, *items):
    """A group of some items."""
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
        group("`R` edges", Subject.TRANSITIONS, "A → P"),
        group("statements of f", Subject.STATEMENTS, "3", "4", "9"),
        group("branches of f", Subject.BRANCHES, "3 → 4", "3 → 9"),
        group("R", Subject.REQUIREMENT, "triggered", "passed"),
    ]
)


@pytest.mark.parametrize(
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
    """Bins in common, sources of transitions, lines before, what else was hit of a group."""
    assert 1 >= nearness(goal, near, MODEL) > nearness(goal, far, MODEL) >= 0
