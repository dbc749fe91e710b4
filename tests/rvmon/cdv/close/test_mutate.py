"""Tests are varied according to the types of their fields."""

import enum
import random
from typing import Annotated, Literal

import msgspec
import pytest

from rvmon import cdv
from rvmon.cdv.close.vary_test import Learned, Mutator


class Colour(enum.Enum):
    RED = "red"
    BLUE = "blue"


class Step(msgspec.Struct, tag="step", frozen=True):
    """A step."""

    length: Annotated[float, msgspec.Meta(gt=0, le=1)]
    times: int = 1


class Turn(msgspec.Struct, tag="turn", frozen=True):
    """A turn with a fixed angle."""

    angle: Literal[90, 180]


class Tree(msgspec.Struct, frozen=True):
    """A recursive type."""

    size: int = 0
    parts: tuple["Tree", ...] = ()


class Row(msgspec.Struct, frozen=True, array_like=True):
    """Written as an array."""

    first: int = 1


class Odd(cdv.Test):
    """All kinds of fields."""

    way: tuple[Step | Turn, ...] = ()
    mixed: int | str = "text"
    tree: Tree = Tree()
    row: Row = Row()
    colour: Colour = Colour.RED
    maybe: int | None = None
    lists: list[list[int]] = msgspec.field(default_factory=list)
    by_name: dict[str, int] = msgspec.field(default_factory=dict)
    some: set[int] = msgspec.field(default_factory=set)
    thirds: Annotated[int, msgspec.Meta(multiple_of=3, ge=0, le=9)] = 3
    sure: bool = False


def changed(tests, count, *, fixed=()):
    """A number of tests, each a variation of an earlier one."""
    rng, learned = random.Random(1), Learned()
    mutator = Mutator(Odd, fixed, learned)
    for _ in range(count):
        made = mutator.mutated(rng.choice(tests[-20:]), tests[-20:], rng, [])
        tests.append(made)
    return tests


@pytest.mark.slow
def test_whatever_is_changed_is_a_test_of_its_type():
    tests = changed([Odd(name="a", strategy="s", seed=1)], 800)
    for one in tests:
        assert msgspec.json.decode(msgspec.json.encode(one), type=Odd) == one
    assert {type(step) for one in tests for step in one.way} == {Step, Turn}
    assert {one.thirds for one in tests} == {0, 3, 6, 9}
    assert {one.sure for one in tests} == {True, False}
    assert {one.colour for one in tests} == set(Colour)
    assert len({one.seed for one in tests}) > 100
    assert any(one.tree.parts for one in tests)


@pytest.mark.slow
def test_descriptions_and_fixed_fields_are_kept():
    """Name, purpose, robot, fault, known answers, and values without neighbours, such as texts."""
    first = Odd(name="a", strategy="s", seed=1, text="t", mutation="m", expected={"R": "F"})
    tests = changed([first], 300, fixed=("seed", "tree.size"))
    for one in tests:
        assert (one.name, one.strategy, one.text, one.robot) == ("a", "s", "t", None)
        assert (one.mutation, one.expected) == ("m", {"R": "F"})
        assert (one.by_name, one.some, one.row) == ({}, set(), Row())
        assert (one.seed, one.tree.size) == (1, 0)
    assert any(one.tree.parts for one in tests)


def test_a_type_without_fields_that_can_change_gives_none():
    first = Odd(name="a", strategy="s", seed=1)
    names = [field.name for field in msgspec.structs.fields(Odd)]
    mutator = Mutator(Odd, names, Learned())
    assert mutator.mutated(first, [first], random.Random(1), []) is None
